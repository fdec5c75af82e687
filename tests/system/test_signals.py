"""Ends by signal, full disks, two runs into one folder, as a user meets them: in processes of their own."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from executive.cli import invoke
from executive.core.errors import LongarmError
from executive.core.interrupts import Interrupted
from executive.record.reader import is_complete, read_record
from executive.record.verify import verify
from executive.run.app import RunOptions, run
from tests.system.bench import Setting

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    """A mission of an hour on the fake robot, whose record is written in a second."""
    file = tmp_path / "short.yaml"
    file.write_text(Setting().text())
    return file


def begun(scenario: Path, out: Path, limit_bytes: int | None = None) -> subprocess.Popen[str]:
    def limited() -> None:
        if limit_bytes is not None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, limit_bytes))

    words = ["from executive.cli import main; main()", "run", str(scenario), "--quiet", "--out", str(out)]
    return subprocess.Popen(
        [sys.executable, "-c", *words],
        cwd=scenario.parent,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=limited,
    )


def wait_for(path: Path, least_bytes: int) -> None:
    for _ in range(3000):
        if path.is_file() and path.stat().st_size >= least_bytes:
            return
        threading.Event().wait(0.005)
    raise AssertionError(f"{path} was not written")


@pytest.mark.parametrize(
    ("number", "after_bytes"),
    [(signal.SIGTERM, 1), (signal.SIGTERM, 20_000), (signal.SIGHUP, 5_000), (signal.SIGINT, 40_000)],
)
def test_a_signal_holds_the_rover_and_leaves_a_result(
    scenario: Path, tmp_path: Path, number: signal.Signals, after_bytes: int
) -> None:
    out = tmp_path / "out"
    process = begun(scenario, out)
    wait_for(out / "record.mcap", after_bytes)
    process.send_signal(number)
    _, told = process.communicate(timeout=60)
    result = json.loads((out / "result.json").read_text())
    if process.returncode == 0:
        pytest.skip("the run had ended before the signal came")
    assert process.returncode == 128 + number
    by = "the operator" if number == signal.SIGINT else number.name
    assert (result["outcome"], result["reason"]) == ("safe_hold", f"interrupted by {by}")
    assert "Traceback" not in told
    assert is_complete(out / "record.mcap")
    assert verify(out).problems == ()


@pytest.mark.parametrize("limit_bytes", [3_000, 30_000])
def test_a_full_disk_ends_in_one_line_with_the_record_readable_up_to_there(
    scenario: Path, tmp_path: Path, limit_bytes: int
) -> None:
    out = tmp_path / "out"
    process = begun(scenario, out, limit_bytes)
    _, told = process.communicate(timeout=60)
    assert process.returncode == 3
    assert told.count("\n") == 1
    assert "Traceback" not in told
    record = out / "record.mcap"
    assert not record.exists() or list(read_record(record))
    assert not list(out.glob(".*.[0-9]*")), "nothing half-written is left"


def test_a_folder_with_a_run_is_written_over_only_by_force(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "out")
    assert invoke(["run", str(scenario), "--quiet", "--out", out]) == 0
    assert invoke(["run", str(scenario), "--quiet", "--out", out]) == 2
    assert "is not empty, expected a new folder, or --force" in capsys.readouterr().err
    assert invoke(["verify-record", out]) == 0
    assert invoke(["run", str(scenario), "--quiet", "--out", out, "--force"]) == 0


def test_a_run_that_cannot_begin_leaves_no_folder(
    scenario: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*given: object) -> None:
        raise LongarmError("no such robot here")

    monkeypatch.setattr("executive.run.app.set_up", refused)
    assert invoke(["run", str(scenario), "--quiet", "--out", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()


def test_of_two_runs_into_one_folder_the_second_is_refused(scenario: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    first = begun(scenario, out)
    wait_for(out / "record.mcap", 1)
    first.send_signal(signal.SIGSTOP)
    second = begun(scenario, out)
    _, told = second.communicate(timeout=60)
    first.send_signal(signal.SIGCONT)
    first.communicate(timeout=60)
    assert second.returncode == 2
    assert "--out:1:1: got" in told
    assert verify(out).problems == ()


def test_a_signal_while_the_world_is_made_leaves_whole_records(tmp_path: Path, monkeypatch: Any) -> None:
    def interrupted(*args: Any) -> None:
        raise Interrupted(signal.SIGTERM)

    monkeypatch.setattr("sim_pybullet.backend.World", interrupted)
    options = RunOptions(out=tmp_path / "run", tier="geometric", bar=False, report=False)
    assert run(ROOT / "scenarios" / "clean_hop.yaml", options).exit_code == 128 + signal.SIGTERM
    assert verify(tmp_path / "run").problems == ()


def test_a_signal_in_a_call_that_cannot_raise_is_raised_later() -> None:
    code = """
import signal, sys
from executive.core import interrupts
interrupts.raise_when_asked()
class Callback:
    def __del__(self):
        signal.raise_signal(signal.SIGTERM)
Callback()
try:
    interrupts.raise_swallowed()
except KeyboardInterrupt as asked:
    sys.exit(interrupts.number_of(asked))
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (signal.SIGTERM, "")
