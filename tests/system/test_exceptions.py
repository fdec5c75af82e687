"""Whatever raises, wherever and whenever: the rover rests, every leaf is halted once, the record is whole."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from executive.cli import invoke
from executive.core.devices import DRIVE
from executive.core.errors import NodeRaised
from executive.pool import Pool
from executive.record import History, events
from executive.record.reader import is_complete
from executive.run.runner import Run
from executive.testing import FakeBackend
from executive.tree.catalogue import node_types
from executive.tree.nodes.base import Leaf
from tests.system.bench import SETTINGS, Broken, Ended, Sabotage, Setting, run

TICKS = (1, 2, 10)
NEVER_ENTERED: dict[str, str] = {}
"""Leaves that no setting reaches, each with the reason."""

Census = dict[Sabotage, Setting]


@pytest.fixture(scope="module")
def leaves() -> set[str]:
    return set()


@pytest.fixture(scope="module")
def census(tmp_path_factory: pytest.TempPathFactory, leaves: set[str]) -> Census:
    """For every call of a leaf that is made at all, the setting that makes it soonest."""
    soonest: dict[Sabotage, tuple[int, Setting]] = {}
    for setting in SETTINGS:
        ended = run(setting, tmp_path_factory.mktemp("census"))
        assert ended.end.defect is None
        leaves |= {node.path for node in ended.built.root.iterate() if isinstance(node, Leaf)}
        for call, tick in ended.diary.when.items():
            if call not in soonest or tick < soonest[call][0]:
                soonest[call] = (tick, setting)
    return {call: setting for call, (_, setting) in soonest.items()}


def breaches(ended: Ended, sabotage: Sabotage) -> list[str]:
    """Every promise that the run did not keep."""
    end = ended.end
    promises = {
        "the run ends as an error": end.outcome == "error",
        "the defect names the leaf": isinstance(end.defect, NodeRaised) and end.defect.path == sabotage.path,
        "the reason names the leaf": sabotage.path in (end.reason or ""),
        "the cause is kept": end.defect is not None and isinstance(end.defect.__cause__, Broken),
        "the leaves alone bring it to rest": ended.rested_by_itself or sabotage.method == "halt",
        **safe(ended),
    }
    return [f"{sabotage}: not kept: {promise}" for promise, kept in promises.items() if not kept]


def safe(ended: Ended) -> dict[str, bool]:
    """What holds at the end of a run whatever broke."""
    stop = History.of(ended.record).last(events.Stop)
    return {
        "every leaf is halted once per entry": ended.diary.halted == ended.diary.begun,
        "no leaf is left entered": not ended.built.trace.entered,
        "the rover rests": not ended.backend.devices[DRIVE].read().moving,
        "the record is closed": is_complete(ended.record),
        "the record ends with a stop": stop is not None and stop.event.outcome == ended.end.outcome,
    }


def test_every_leaf_of_the_shipped_trees_is_entered(census: Census, leaves: set[str]) -> None:
    entered = {call.path for call in census}
    assert leaves - entered == set(NEVER_ENTERED)
    assert len(leaves) > 50


@pytest.mark.parametrize("tick", TICKS)
def test_a_leaf_that_raises_at_a_tick_leaves_the_rover_safe(
    census: Census, tmp_path: Path, tick: int
) -> None:
    """At its first tick in every place where it stands, at later ones once for each type of leaf."""
    calls = [call for call in census if call.method == "step" and call.call == tick]
    calls = calls if tick == 1 else list({type_of(call.path): call for call in calls}.values())
    assert len(calls) > (20 if tick == 1 else 6)
    assert [b for call in calls for b in breaches(run(census[call], tmp_path, call), call)] == []


@pytest.mark.parametrize("method", ["begin", "halt"])
def test_a_leaf_that_raises_on_entry_or_exit_leaves_the_rover_safe(
    census: Census, leaves: set[str], tmp_path: Path, method: str
) -> None:
    one_of_each = {type_of(path): path for path in sorted(leaves)}
    assert len(one_of_each) > 18
    calls = [Sabotage(path, method, 1) for path in one_of_each.values()]
    assert [b for call in calls for b in breaches(run(census[call], tmp_path, call), call)] == []


def type_of(path: str) -> str:
    return path.rpartition("/")[2].partition("#")[0]


def break_in(obj: Any, name: str, after: int = 0, error: BaseException | None = None) -> None:
    """Let `obj.name` raise from its call number `after` + 1 on."""
    real, calls = getattr(obj, name), itertools.count(1)

    def broken(*args: Any, **kwargs: Any) -> Any:
        if next(calls) > after:
            raise error or Broken(f"{name} is broken")
        return real(*args, **kwargs)

    setattr(obj, name, broken)


@pytest.mark.parametrize(
    ("port", "method"),
    [
        ("tracks", "drive"),
        ("tracks", "read"),
        ("inclinometer", "read"),
        ("tether", "read"),
        ("head", "read"),
        ("cameras", "take"),
    ],
)
@pytest.mark.parametrize("after", [0, 3])
def test_a_device_that_raises_leaves_the_rover_safe(
    tmp_path: Path, port: str, method: str, after: int
) -> None:
    def alter(made: Run) -> None:
        break_in(made.backend.devices.named(port), method, after)

    ended = run(Setting(), tmp_path, alter=alter)
    # the fake's own reading at the end would raise too: ask the robot itself
    ended.backend.devices[DRIVE].__dict__.pop("read", None)
    assert (ended.end.outcome, ended.end.defect is None) == ("error", False)
    assert f"{method} is broken" in (ended.end.reason or "")
    assert [promise for promise, kept in safe(ended).items() if not kept] == []


def test_a_localizer_that_raises_is_told_with_the_leaf_that_asked(tmp_path: Path) -> None:
    ended = run(Setting(), tmp_path, alter=lambda made: break_in(made.services.localizer, "locate"))
    assert ended.end.reason == (
        "navigate/selector/mission/find_rover/recover/localise: Broken: locate is broken"
    )
    assert all(safe(ended).values())


def test_a_strategy_whose_needs_raise_is_named(tmp_path: Path) -> None:
    def needs(situation: object) -> str | None:
        raise Broken("needs are broken")

    def alter(made: Run) -> Run:
        pool = Pool(
            [replace(s, needs=needs) for s in made.services.pool.strategies.values()],
            made.services.journal.strategy,
        )
        made.services.pool.choose = pool.choose
        return made

    ended = run(Setting(blind_every=1), tmp_path, alter=alter)
    assert ended.end.outcome == "error"
    assert (ended.end.reason or "").startswith("navigate/selector/mission/find_rover/recover: StrategyRaised")
    assert "needs of cabin_reposing: Broken: needs are broken" in (ended.end.reason or "")
    assert all(safe(ended).values())


@pytest.mark.parametrize(
    "method", ["estimate", "segment", "waypoint", "assessment", "views", "strategy", "telemetry", "write"]
)
def test_a_journal_that_raises_leaves_the_rover_safe(tmp_path: Path, method: str) -> None:
    def alter(made: Run) -> None:
        break_in(made.journal, method)
        # these were given the method before it broke
        made.services.pool._note = made.journal.strategy
        made.services.classification._announce = made.journal.assessment

    ended = run(Setting(blind_every=3), tmp_path, alter=alter)
    kept = safe(ended)
    if method == "write":
        assert not kept.pop("the record ends with a stop")  # the stop is written by what is broken
    assert ended.end.outcome == "error"
    assert f"{method} is broken" in (ended.end.reason or "")
    assert all(kept.values())


def test_a_recorder_that_cannot_write_leaves_the_rover_safe(tmp_path: Path) -> None:
    full = OSError(28, "No space left on device")
    ended = run(Setting(), tmp_path, alter=lambda made: break_in(made.recorder, "flush", 50, full))
    assert ended.end.reason == "OSError: [Errno 28] No space left on device"
    assert all(safe(ended).values())


def test_a_backend_that_raises_as_time_passes_leaves_the_rover_safe(tmp_path: Path) -> None:
    ended = run(Setting(), tmp_path, alter=lambda made: break_in(made.backend, "advance", 40))
    assert ended.end.reason == "Broken: advance is broken"
    assert all(safe(ended).values())


@pytest.mark.parametrize("at_tick", [0, 13, 60])
def test_an_interrupt_holds_the_rover_and_closes_the_record(tmp_path: Path, at_tick: int) -> None:
    def alter(made: Run) -> None:
        break_in(made.root, "tick_once", at_tick, KeyboardInterrupt())

    ended = run(Setting(), tmp_path, alter=alter)
    assert (ended.end.outcome, ended.end.reason) == ("safe_hold", "interrupted by the operator")
    assert ended.end.defect is None
    assert all(safe(ended).values())


def test_an_interrupt_while_coming_to_rest_does_not_keep_it_from_resting(tmp_path: Path) -> None:
    stops = []

    def alter(made: Run) -> None:
        advance, stop = made.backend.advance, made.backend.safe_stop

        def interrupted() -> None:
            if made.backend.devices[DRIVE].read().moving:
                raise KeyboardInterrupt
            advance()

        def noted_stop() -> None:
            stops.append(made.backend.devices[DRIVE].read().moving)
            stop()

        made.backend.advance, made.backend.safe_stop = interrupted, noted_stop
        break_in(made.trace, "terminate_entered", 0, KeyboardInterrupt())

    ended = run(Setting(), tmp_path, alter=alter)
    # nobody halted the leaves: the drive was brought to rest as its spec says, and the backend is stopped too
    assert stops == [False]
    assert not ended.backend.devices[DRIVE].read().moving
    assert is_complete(ended.record)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a scenario for navigate and one for dead_reckoning."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.yaml").write_text(Setting().text())
    (tmp_path / "blind.yaml").write_text(Setting("dead_reckoning").text())
    return tmp_path


@pytest.mark.parametrize("leaf", ["turn_towards", "localise", "watch_motion", "drive_blind"])
def test_a_leaf_that_raises_ends_the_command_with_3_and_a_traceback(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, leaf: str
) -> None:
    def broken(self: Leaf) -> None:
        raise Broken("step is broken")

    monkeypatch.setattr(node_types()[leaf].leaf, "step", broken)
    file = "blind.yaml" if leaf == "drive_blind" else "short.yaml"
    assert invoke(["run", file, "--out", "out", "--quiet"]) == 3
    told = capsys.readouterr()
    result = json.loads((folder / "out" / "result.json").read_text())
    assert told.out == ""
    assert told.err.count("\n") == 1
    assert f"/{leaf}: Broken: step is broken (out/traceback.txt)" in told.err
    assert result["outcome"] == "error"
    assert f"/{leaf}: Broken: step is broken" in result["reason"]
    assert f"NodeRaised: {result['reason']}" in (folder / "out" / "traceback.txt").read_text()
    assert is_complete(folder / "out" / "record.mcap")
    assert "step is broken" in (folder / "out" / "report.html").read_text()


def test_an_interrupted_command_still_reports_and_says_by_which_signal(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(self: FakeBackend) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(FakeBackend, "advance", interrupted)
    assert invoke(["run", "short.yaml", "--out", "out", "--json"]) == 130
    result = json.loads(capsys.readouterr().out)
    assert (result["outcome"], result["reason"]) == ("safe_hold", "interrupted by the operator")
    assert {path.name for path in (folder / "out").iterdir()} == {
        "files",
        "sums.json",
        "scenario.yaml",
        "record.mcap",
        "result.json",
        "report.html",
    }


@pytest.mark.parametrize(
    "broken", ["executive.testing.fake.FakeBackend", "executive.testing.fake.OverheadLocalizer"]
)
def test_a_plug_in_that_cannot_be_made_leaves_a_whole_record(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, broken: str
) -> None:
    def make(self: object, *args: object, **kwargs: object) -> None:
        raise Broken("cannot be made")

    monkeypatch.setattr(f"{broken}.__init__", make)
    assert invoke(["run", "short.yaml", "--out", "out", "--quiet"]) == 3
    assert capsys.readouterr().err == "longarm: a defect: Broken: cannot be made (out/traceback.txt)\n"
    result = json.loads((folder / "out" / "result.json").read_text())
    assert (result["scenario"], result["outcome"], result["reason"]) == (
        "short",
        "error",
        "Broken: cannot be made",
    )
    assert is_complete(folder / "out" / "record.mcap")
    assert (folder / "out" / "report.html").is_file()


def test_a_defect_of_the_report_keeps_the_record_and_a_traceback(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*args: object) -> None:
        raise Broken("cannot be drawn")

    monkeypatch.setattr("executive.run.app.write_report", broken)
    assert invoke(["run", "short.yaml", "--out", "out", "--quiet"]) == 3
    assert "longarm: a defect: Broken: cannot be drawn" in capsys.readouterr().err
    assert "Broken: cannot be drawn" in (folder / "out" / "traceback.txt").read_text()
    assert json.loads((folder / "out" / "result.json").read_text())["outcome"] == "reached"
