"""Cases in child processes, and trials that go from case to case."""

from __future__ import annotations

from pathlib import Path

import pytest

from executive.errors import ConfigError
from executive.tree.load import load_tree
from proving.coverage.run import Case, Ended, run_cases
from proving.coverage.suite import Verdict, scenario_files, verdict_of
from proving.coverage.trials import conduct


def test_cases_run_in_children_and_leave_their_folders(suite, tmp_path):
    cases = [Case(str(seed), suite / "plain.yaml", tmp_path / str(seed), seed=seed) for seed in (1, 2)]
    ends = {ended.case.key: ended for ended in run_cases(cases, 2)}
    assert {key: ended.result["seed"] for key, ended in ends.items()} == {"1": 1, "2": 2}
    assert (tmp_path / "1" / "record.mcap").is_file()
    assert not (tmp_path / "1" / "report.html").exists()


def test_what_takes_too_long_is_killed_and_the_next_goes_on(suite, tmp_path):
    long = Case("long", suite / "plain.yaml", tmp_path / "long", wall_s=0.02)
    short = Case("short", suite / "plain.yaml", tmp_path / "short")
    ends = {ended.case.key: ended for ended in run_cases([long, short], 1)}
    assert (ends["long"].cause, ends["long"].result) == ("hang", None)
    assert ends["short"].result["outcome"] == "reached"


def test_a_case_that_is_no_scenario_is_refused_with_its_problems(tmp_path):
    file = tmp_path / "bad.yaml"
    file.write_text("scenario: bad\nmission: {mission: bad, waypoints: []}\n")
    (ended,) = run_cases([Case("bad", file, tmp_path / "run")], 1)
    assert ended.cause == "refused"
    assert "bad.yaml:2" in ended.detail


def test_a_tree_file_can_be_taken_to_say_something_else(suite, tmp_path):
    path = Path(load_tree("find_rover").file).absolute()
    blind = (
        "tree: find_rover\nports: {pose: {type: PoseEstimate, direction: inout}}\nroot: {oops: {}}\n"
    )
    wrong, right = blind, blind.replace("{oops: {}}", "{force_failure: {take_picture: {}}}")
    ends = [
        *run_cases([Case("wrong", suite / "plain.yaml", tmp_path / "wrong", instead={path: wrong})], 1),
        *run_cases([Case("right", suite / "plain.yaml", tmp_path / "right", instead={path: right})], 1),
    ]
    assert [ended.cause for ended in ends] == ["refused", ""]
    assert ends[1].result["outcome"] == "help"


def test_trials_take_turns_and_decide_what_comes_next():
    def run(cases, slots):
        for case in iter(lambda: next(cases, None), None):
            yield Ended(case, {"key": case.key})

    def trial(name, rounds):
        seen = []
        for number in range(rounds):
            ended = yield Case(f"{name}{number}", None, None)
            seen.append(ended.result["key"])
        return seen

    found = list(conduct([trial("a", 3), trial("none", 0), trial("b", 1)], 2, run))
    assert sorted(found) == [[], ["a0", "a1", "a2"], ["b0"]]


def verdict(outcome="reached", held=(), missed=(), passed=True):
    return Verdict(passed, outcome, frozenset(held), missed, {"reason": "r"})


@pytest.mark.parametrize(
    ("after", "why"),
    [
        (verdict(held=("a", "b")), None),
        (verdict(held=("a",), missed=("b",), passed=False), "b"),
        (verdict(held=("a",)), "b"),
        (verdict(outcome="help", held=("a", "b"), passed=False), "ended help"),
        (verdict(outcome="error", passed=False), "error: r"),
        (verdict(outcome="invalid", held=("a", "b"), passed=False), "invalid: r"),
        (verdict(held=("a", "b"), missed=("c",), passed=True), None),
    ],
)
def test_a_verdict_is_worse_when_something_that_held_no_longer_does(after, why):
    assert after.worse_than(verdict(held=("a", "b"))) == why


def test_without_expectations_reaching_the_goal_is_what_is_expected():
    result = {"outcome": "help", "expectations": [], "digest": "x", "wall": {}, "wall_s": 1.0}
    assert not verdict_of(Ended(None, result)).passed
    assert verdict_of(Ended(None, result | {"outcome": "reached"})).passed


def test_a_suite_is_every_scenario_file_below_a_folder(suite, tmp_path):
    (tmp_path / "tree.yaml").write_text("tree: t\nroot: {wait: {duration: 1 s}}\n")
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "plain.yaml").write_text((suite / "plain.yaml").read_text())
    assert scenario_files([tmp_path]) == [tmp_path / "deep" / "plain.yaml"]


def test_every_bad_scenario_of_a_suite_is_told_at_once(tmp_path):
    for name in ("a", "b"):
        (tmp_path / f"{name}.yaml").write_text(f"scenario: {name}\nseed: x\n")
    with pytest.raises(ConfigError) as caught:
        scenario_files([tmp_path])
    assert {problem.file.rsplit("/", 1)[-1] for problem in caught.value.problems} == {"a.yaml", "b.yaml"}


def test_a_folder_without_scenarios_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="expected a scenario file or a folder of some"):
        scenario_files([tmp_path])
