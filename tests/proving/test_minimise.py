"""The minimiser: what is left of a failing case, and that it still fails in the same way."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
import yaml

from executive.core.errors import ConfigError
from executive.record import RunResult, StrategyRow, read_result, write_result
from executive.record.rows import JudgedRow
from executive.run.app import RunOptions, run
from executive.run.resolve import resolve_scenario
from proving.engine import Case, CaseClass, Ending
from proving.minimise.command import minimise as command_line
from proving.minimise.failure import Failure, failure_of
from proving.minimise.fewer import fewer
from proving.minimise.minimise import minimise

PAIR = '''\
"""Two faults that are harmless each by itself; together they blind the localizer for good."""

from dataclasses import dataclass

from pydantic import BaseModel

from executive.record import RunResult
from executive.record.rows import JudgedRow
from executive.run.fault import Fault, FaultSpec
from executive.core.types import Outcome, Reason

ACTIVE = set()


class Nothing(BaseModel):
    pass


class Half(Fault):
    def __init__(self, parameters):
        self.told = 0

    def wrap_localizer(self, localizer, cue):
        return Blinded(localizer, cue, self)

    def took_effect(self):
        return self.told > 0


@dataclass
class Blinded:
    inner: object
    cue: object
    fault: Half

    def locate(self, request):
        if self.cue.active:
            ACTIVE.add(id(self))
            self.fault.told += 1
        return Lost() if len(ACTIVE) == 2 else self.inner.locate(request)

    def __getattr__(self, name):
        return getattr(self.inner, name)


class Lost:
    def poll(self):
        return Outcome(Reason.NOT_SEEN, "both halves are there")

    def cancel(self):
        pass


LEFT_HALF = FaultSpec("left_half", "Half of a fault.", Nothing, Half, "marker_lost")
RIGHT_HALF = FaultSpec("right_half", "The other half.", Nothing, Half, "marker_lost")
'''
FIVE = """\
scenario: five
mission:
  mission: short
  waypoints:
    - {x: 2.0 m, y: 0 m}
    - {x: 2.1 m, y: 0 m}
    - {x: 2.2 m, y: 0 m}
backend: fake
localizer: overhead
tier: geometric
world: {pixel_sigma: 0.7}
time_limit: 40 min
faults:
  - encoder_scale: {side: left, factor: 101 %}
  - left_half: {}
    from: {node: localise, count: 4}
  - encoder_scale: {side: right, factor: 101 %}
    name: other_side
    from: {waypoint: 1}
  - right_half: {}
    from: {waypoint: 1}
  - frozen_frame: {}
    from: {node: localise, count: 2}
    for: 2 min
expect: {outcome: reached}
"""


@pytest.fixture
def five(tmp_path, monkeypatch):
    """A case with five faults, two of which together make it fail."""
    folder = tmp_path / "plugins"
    info = folder / "pair-0.dist-info"
    info.mkdir(parents=True)
    (folder / "pair_of_faults.py").write_text(PAIR)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: pair\nVersion: 0\n")
    points = "left_half = pair_of_faults:LEFT_HALF\nright_half = pair_of_faults:RIGHT_HALF\n"
    (info / "entry_points.txt").write_text(f"[longarm.faults]\n{points}")
    monkeypatch.syspath_prepend(str(folder))
    file = tmp_path / "five.yaml"
    file.write_text(FIVE)
    return file


def test_a_part_without_which_it_does_not_happen_is_found():
    tried = []

    def still(rest):
        tried.append(list(rest))
        return {3, 7} <= set(rest)

    assert fewer(range(10), still) == [3, 7]
    assert len(tried) < 40
    assert all(sorted(rest) == rest for rest in tried)


def test_nothing_is_left_of_what_does_not_matter_and_no_less_than_is_asked_for():
    assert fewer([1, 2, 3], lambda rest: True) == []
    assert fewer([1, 2, 3, 4, 5], lambda rest: True, least=2) == [4, 5]
    assert fewer([1, 2, 3], lambda rest: False) == [1, 2, 3]
    assert fewer([], lambda rest: True) == []


def test_a_case_of_five_faults_shrinks_to_the_two_that_make_it_fail(five, tmp_path):
    told = []
    made = minimise(five, tell=told.append, loosely=True)
    assert made.failure.is_as(Failure("expectation", "outcome is reached"), loosely=True)
    kinds = [next(iter(entry)) for entry in made.after["faults"]]
    assert kinds == ["left_half", "right_half"]
    assert len(made.after["mission"]["waypoints"]) == 2
    assert "world" not in made.after
    assert 5 < made.runs < 60
    assert not made.exhausted
    assert len(told) == len(made.steps) > 2

    file = tmp_path / "small.yaml"
    file.write_text(made.text(five))
    again = run(file, RunOptions(out=tmp_path / "run", bar=False, report=False))
    assert again.exit_code == 1
    assert [row.met for row in again.result.expectations] == [False]
    assert len(file.read_text().splitlines()) < 20


def test_the_runs_are_bounded_and_the_same_ones_come_again(five):
    made = minimise(five, most=3)
    assert (made.runs, made.exhausted) == (3, True)
    assert made.failure is not None
    assert minimise(five, most=3) == made


def test_a_run_folder_is_minimised_from_its_own_scenario(suite, tmp_path, capsys):
    file = tmp_path / "blind.yaml"
    text = (suite / "frozen.yaml").read_text().replace("for: 10 min", "for: 3 h")
    file.write_text(text + "  - encoder_scale: {side: left, factor: 101 %}\n")
    run(file, RunOptions(out=tmp_path / "run", bar=False, report=False))
    output = tmp_path / "minimal.yaml"
    arguments = [str(tmp_path / "run"), "-o", str(output), "--loosely", "--json"]
    assert command_line.main(arguments, standalone_mode=False) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["sizes"]["faults"] == {"before": 2, "after": 1}
    data = yaml.safe_load(output.read_text())
    (fault,) = data["faults"]
    assert set(fault) <= {"frozen_frame", "for"}
    assert int(fault["for"].split()[0]) < 3 * 3600 / 2
    assert resolve_scenario(output).name == "frozen"


def test_a_case_that_does_not_fail_is_left_alone(suite, tmp_path, capsys):
    output = tmp_path / "minimal.yaml"
    assert command_line.main([str(suite / "plain.yaml"), "-o", str(output)], standalone_mode=False) == 1
    assert "does not fail" in capsys.readouterr().err
    assert not output.exists()


def test_what_is_no_scenario_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        minimise(tmp_path / "nothing.yaml")


def ended(suite, kind=CaseClass.OK, cause="", **result):
    case = Case("c", suite, suite)
    kept = RunResult(**{"outcome": "reached"} | result)
    return failure_of(Ending(case, kind, cause), kept, resolve_scenario(suite / "plain.yaml"))


def is_loosely(failure, kind, text):
    return failure.is_as(Failure(kind, text), loosely=True)


def row(text, met, when_s=None):
    return JudgedRow(text, met, t_violation_s=when_s)


def test_what_was_violated_first_is_the_failure(suite):
    rows = [row("late", False, 90.0), row("early", False, 10.0), row("fine", True), row("at the end", False)]
    assert is_loosely(ended(suite, expectations=rows), "expectation", "early")
    assert is_loosely(ended(suite, expectations=rows, safety=[row("tilt", False)]), "unsafe", "tilt")
    assert ended(suite, expectations=[row("fine", True)]) is None


def test_a_defect_is_known_by_its_exception_and_a_hang_by_being_one(suite):
    reason = "navigate/selector/mission/localise: ValueError: 17 is broken"
    assert is_loosely(
        ended(suite, CaseClass.SUT, "error", outcome="error", reason=reason), "error", "ValueError"
    )
    assert is_loosely(ended(suite, CaseClass.SUT, "hang", outcome="error", reason="hang: x"), "error", "hang")
    invalid = "frozen_frame never took effect; the run ended reached"
    assert is_loosely(ended(suite, outcome="invalid", reason=invalid), "invalid", "frozen_frame")
    assert is_loosely(ended(suite, outcome="help"), "outcome", "help")


HELP = "no_strategy: navigate/mission/recover: no strategy fits; {}"


def test_numbers_do_not_make_another_failure_but_reason_place_and_hypothesis_do(suite):
    def helped(reason, hypothesis="lost_rover"):
        row = StrategyRow("fresh_look", 1.0, hypothesis, 0.9)
        return ended(suite, outcome="help", reason=HELP.format(reason), strategies=(row,))

    first = helped("device: pan stands still at 12.5 deg")
    assert first.place == "navigate/mission/recover"
    assert first.is_as(helped("device: pan stands still at -3 deg"))
    misaligned = helped("misaligned: the head is 0.4 deg off")
    assert not misaligned.is_as(first)
    assert misaligned.is_as(first, loosely=True)
    assert "reason" in next(first.differences(misaligned))
    assert not first.is_as(helped("device: pan stands still at 12.5 deg", "head_misaligned"))
    assert not first.is_as(ended(suite, outcome="safe_hold"), loosely=True)


def test_a_case_that_now_fails_otherwise_than_its_record_says_is_told_so(suite, tmp_path):
    file = tmp_path / "blind.yaml"
    file.write_text((suite / "frozen.yaml").read_text().replace("for: 10 min", "for: 3 h"))
    run(file, RunOptions(out=tmp_path / "run", bar=False, report=False))
    result = read_result(tmp_path / "run" / "result.json")
    assert minimise(tmp_path / "run", most=1).weaker == ()
    write_result(tmp_path / "run" / "result.json", replace(result, reason="device: pan stands still"))
    assert any("pan stands still" in words for words in minimise(tmp_path / "run", most=1).weaker)
