"""A run that was killed, at any byte, goes on: what it has recorded stays, and it ends as it would have."""

from __future__ import annotations

import bisect
import os
import shutil
import signal
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from executive.core.errors import ConfigError, RecordError
from executive.record import History, digest, events, read_record, read_result
from executive.record.continuation import Diverged, cut_ticks
from executive.record.verify import verify
from executive.run import app
from executive.run.resume import resume

ROOT = Path(__file__).parents[2]

MISSION = """\
scenario: short_hop
seed: 3
tier: geometric
mission:
  mission: short_hop
  tree: navigate
  segments: {on_track: 30 mm, off_track: 250 mm, tolerance: 30 mm}
  waypoints: [{x: 2.6 m, y: -0.4 m}, {x: 2.85 m, y: -0.35 m}]
"""
ENDINGS = ("result.json", "report.html", "sums.json")


@pytest.fixture(scope="module")
def twin(tmp_path_factory) -> Path:
    """The run that is not killed."""
    folder = tmp_path_factory.mktemp("twin")
    (folder / "short_hop.yaml").write_text(MISSION)
    return app.run(folder / "short_hop.yaml", app.RunOptions(out=folder / "run", bar=False)).folder


def killed(twin: Path, folder: Path, at: int, tail: bytes = b"") -> Path:
    """What a kill leaves where `at` bytes of the record had reached the disk."""
    shutil.copytree(twin, folder)
    for name in ENDINGS:
        (folder / name).unlink()
    whole = (twin / "record.mcap").read_bytes()
    (folder / "record.mcap").write_bytes(whole[:at] + tail)
    truth = folder / "truth.mcap"
    truth.write_bytes(truth.read_bytes()[: truth.stat().st_size * at // len(whole)])
    return folder


def messages(folder: Path) -> list:
    return list(read_record(folder / "record.mcap"))


def of(folder: Path, event: type) -> list:
    return History.of(folder / "record.mcap").all(event)


def while_driving(twin: Path) -> int:
    """A size of the record at which the rover had been under way for 20 s."""
    drive = next(at for at in of(twin, events.Command) if at.event.verb == "drive")
    whole, part = (twin / "record.mcap").read_bytes(), twin.parent / "part.mcap"

    def end_s(size: int) -> float:
        part.write_bytes(whole[:size])
        return max((message.time_s for message in read_record(part)), default=0.0)

    return bisect.bisect_left(range(len(whole)), drive.time_s + 20.0, key=end_s)


def count_of(twin: Path, size: int) -> int:
    """How many messages the first `size` bytes of the record hold."""
    part = twin.parent / "part.mcap"
    part.write_bytes((twin / "record.mcap").read_bytes()[:size])
    return len(list(read_record(part)))


@pytest.mark.parametrize("seed", range(5))
def test_a_run_cut_off_at_any_byte_goes_on_to_the_same_end(twin, tmp_path, seed):
    size = (twin / "record.mcap").stat().st_size
    folder = killed(twin, tmp_path / "run", int(np.random.default_rng(seed).integers(size)))
    before = messages(folder)
    finished = resume(folder, bar=False)
    assert messages(folder)[: len(before)] == before
    assert finished.result.outcome == read_result(twin / "result.json").outcome
    assert not verify(folder).problems
    assert sorted(path.name for path in folder.iterdir()) == sorted(path.name for path in twin.iterdir())


def test_a_rover_that_moved_stops_and_is_looked_at_before_it_drives_on(twin, tmp_path):
    folder = killed(twin, tmp_path / "run", while_driving(twin))
    began = len(messages(folder))
    resume(folder, bar=False)
    (cut,) = of(folder, events.Resumed)
    commands = [
        at for at in of(folder, events.Command) if at.time_s >= cut.time_s and at.event.device == "tracks"
    ]
    look = [at for at in of(folder, events.NodeChange) if at.event.path == "after_a_cut/look"]
    assert [at.event.status for at in look] == ["running", "success"]
    assert [at.event.verb for at in commands[:2]] == ["stop", "drive"]
    assert commands[0].time_s <= look[1].time_s <= commands[1].time_s
    assert began < len(messages(folder))


def test_a_run_killed_before_there_was_a_world_has_its_truth_in_the_end(twin, tmp_path):
    folder = killed(
        twin, tmp_path / "run", bisect.bisect_left(range(100_000), 2, key=partial(count_of, twin))
    )
    assert {message.time_s for message in messages(folder)} == {0.0}
    assert resume(folder, bar=False).result.truth.final_error_m is not None
    assert not verify(folder).problems


def test_a_torn_last_block_is_left_out(twin, tmp_path):
    at = while_driving(twin) // 4096 * 4096
    folder = killed(twin, tmp_path / "run", at, tail=np.random.default_rng(1).bytes(3000))
    assert resume(folder, bar=False).result.outcome == "reached"
    assert not verify(folder).problems


def test_a_run_that_is_cut_off_twice_is_cut_at_the_same_ticks_when_it_is_repeated(twin, tmp_path):
    once = killed(twin, tmp_path / "once", while_driving(twin))
    resume(once, bar=False)
    twice = killed(once, tmp_path / "twice", (once / "record.mcap").stat().st_size * 3 // 4)
    finished = resume(twice, bar=False)
    ticks = cut_ticks(twice / "record.mcap")
    assert len(ticks) == len(finished.result.resumed_s) == 2
    options = app.RunOptions(out=tmp_path / "again", bar=False, report=False, cut_ticks=ticks)
    assert app.run(twice / "scenario.yaml", options).result.digest == digest(twice / "record.mcap")


def test_a_record_that_is_not_of_this_run_is_refused_and_stays_as_it_was(twin, tmp_path):
    folder = killed(twin, tmp_path / "run", while_driving(twin))
    text = (folder / "scenario.yaml").read_text()
    (folder / "scenario.yaml").write_text(text.replace("seed: 3", "seed: 4"))
    record = (folder / "record.mcap").read_bytes()
    with pytest.raises(Diverged, match="at 0 s, /start"):
        resume(folder, bar=False)
    assert (folder / "record.mcap").read_bytes() == record
    assert not list(folder.glob("*.anew"))


def test_a_signal_while_the_world_is_brought_back_leaves_the_run_as_it_was(twin, tmp_path, monkeypatch):
    from executive.core import interrupts

    folder = killed(twin, tmp_path / "run", while_driving(twin))
    record = (folder / "record.mcap").read_bytes()

    def asked(run):
        raise interrupts.Interrupted(signal.SIGTERM)

    monkeypatch.setattr("executive.run.runner._advance", asked)
    with pytest.raises(interrupts.Interrupted):
        resume(folder, bar=False)
    monkeypatch.undo()
    assert (folder / "record.mcap").read_bytes() == record
    assert resume(folder, bar=False).result.outcome == "reached"


def test_a_run_that_has_ended_is_told_as_it_ended(twin, tmp_path):
    folder = shutil.copytree(twin, tmp_path / "run")
    (folder / "report.html").unlink()
    finished = resume(folder, bar=False)
    assert (finished.result.digest, finished.exit_code) == (read_result(twin / "result.json").digest, 0)
    assert (folder / "report.html").is_file()


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(RecordError, match=r"got no scenario\.yaml"):
        resume(tmp_path, bar=False)


def test_a_run_whose_tree_has_changed_since_is_refused_unless_as_begun(tmp_path):
    (tmp_path / "mine.yaml").write_text(
        (ROOT / "trees/navigate.yaml").read_text().replace("tree: navigate", "tree: mine")
    )
    (tmp_path / "hop.yaml").write_text(MISSION.replace("tree: navigate", "tree: mine"))
    folder = app.run(tmp_path / "hop.yaml", app.RunOptions(out=tmp_path / "twin", bar=False)).folder
    cut = killed(folder, tmp_path / "run", while_driving(folder))
    (tmp_path / "mine.yaml").write_text((tmp_path / "mine.yaml").read_text() + "# another\n")
    with pytest.raises(ConfigError, match=r"got a change in tree mine\.yaml: line \d+.*--as-begun"):
        resume(cut, bar=False)
    assert resume(cut, bar=False, as_begun=True).result.outcome == "reached"


def test_a_copy_in_the_run_folder_that_has_changed_is_refused(tmp_path):
    (tmp_path / "mine.yaml").write_text(
        (ROOT / "trees/navigate.yaml").read_text().replace("tree: navigate", "tree: mine")
    )
    (tmp_path / "hop.yaml").write_text(MISSION.replace("tree: navigate", "tree: mine"))
    folder = app.run(tmp_path / "hop.yaml", app.RunOptions(out=tmp_path / "run", bar=False)).folder
    for name in ENDINGS:
        (folder / name).unlink()
    copy = next((folder / "files").rglob("mine.yaml"))
    copy.write_text(copy.read_text() + "# another\n")
    with pytest.raises(ConfigError, match=r"got a change in files/.*mine\.yaml"):
        resume(folder, bar=False, as_begun=True)


@pytest.mark.parametrize("number", [signal.SIGTSTP, signal.SIGUSR1])
def test_a_run_that_was_paused_ends_as_without(twin, tmp_path, monkeypatch, number):
    from executive.run import runner

    advance, stopped = runner._advance, []

    def advance_and_pause(run):
        if run.services.clock.ticks == 50:
            os.kill(os.getpid(), number)
            if number == signal.SIGUSR1:
                signal.setitimer(signal.ITIMER_REAL, 0.3)
        advance(run)

    def on(*_):
        stopped.append(True)
        os.kill(os.getpid(), signal.SIGUSR1)

    monkeypatch.setattr(runner, "_advance", advance_and_pause)
    monkeypatch.setattr("executive.core.pause.stop_process", lambda: stopped.append(True))
    before = signal.signal(signal.SIGALRM, on)
    try:
        options = app.RunOptions(out=tmp_path / "run", bar=False, report=False)
        finished = app.run(twin.parent / "short_hop.yaml", options)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert stopped == [True]
    assert finished.result.digest == read_result(twin / "result.json").digest
