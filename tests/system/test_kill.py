"""A run that is killed leaves a record that reads up to the last second, and a report that says so."""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from executive.cli import invoke
from executive.record import History, events, read_record
from executive.record.reader import is_complete
from executive.run.resolve import resolve_scenario

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.sim


def progress_s(record: Path) -> float:
    """Mission time that the record has come to [s]."""
    return (
        max((message.time_s for message in read_record(record)), default=-1.0) if record.is_file() else -1.0
    )


def under_way(process: subprocess.Popen[bytes], for_s: float) -> None:
    """Wait so long for the end of the process, which must not come."""
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(timeout=for_s)


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, float]:
    """The folder of a run killed in the middle, and the mission time seen a wall second before."""
    folder = tmp_path_factory.mktemp("killed") / "out"
    command = [
        sys.executable,
        "-c",
        "from executive.cli import main; main()",
        "run",
        "--tier",
        "geometric",
    ]
    command += [str(ROOT / "missions" / "first_traverse.yaml"), "--quiet", "--out", str(folder)]
    process = subprocess.Popen(command, cwd=folder.parent, env=os.environ | {"PYTHONPATH": str(ROOT)})
    try:
        for _ in range(600):
            if progress_s(folder / "record.mcap") >= 100.0:
                break
            under_way(process, 0.1)
        seen_s = progress_s(folder / "record.mcap")
        assert seen_s >= 100.0, "the run did not get under way"
        under_way(process, 1.0)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    return folder, seen_s


def test_a_killed_run_is_recorded_up_to_the_last_second(killed: tuple[Path, float]) -> None:
    folder, seen_s = killed
    assert progress_s(folder / "record.mcap") > seen_s
    assert not is_complete(folder / "record.mcap")
    history = History.of(folder / "record.mcap")
    assert history.last(events.Start) is not None
    assert history.last(events.Stop) is None
    gaps = [at.time_s for at in history.all(events.Telemetry)]
    assert max(b - a for a, b in itertools.pairwise(gaps)) <= 10.0  # one sample each ten seconds


def test_the_truth_of_a_killed_run_goes_as_far_as_its_record(killed: tuple[Path, float]) -> None:
    folder, _ = killed
    record, truth = progress_s(folder / "record.mcap"), progress_s(folder / "truth.mcap")
    assert abs(record - truth) <= 61.0  # a rover at rest writes its truth once a minute
    assert truth > 0.0


def test_a_killed_run_is_reported_as_cut(
    killed: tuple[Path, float], capsys: pytest.CaptureFixture[str]
) -> None:
    folder, _ = killed
    assert invoke(["report", str(folder)]) == 0
    assert capsys.readouterr().out.strip() == str(folder / "report.html")
    assert "the record ends without a stop" in (folder / "report.html").read_text()


def test_a_killed_run_can_be_repeated_from_its_folder(killed: tuple[Path, float]) -> None:
    folder, _ = killed
    again = resolve_scenario(folder / "scenario.yaml")
    assert again.name == "first_traverse"
    assert again.tier == "geometric"
