"""Scenarios with faults on the fake robot, run as the app runs them; and what must hold however they end."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any
from unittest.mock import patch

from executive.cli import invoke
from executive.record import History, events, read_result
from executive.record.reader import is_complete
from executive.record.run_result import FaultStages
from executive.run.app import Finished, RunOptions
from executive.run.app import run as run_file
from executive.testing import FakeBackend

HEAD = {
    "scenario": "short",
    "backend": "fake",
    "localizer": "overhead",
    "tier": "geometric",
    "time_limit": "1 h",
    "mission": {
        "mission": "short",
        "waypoints": [{"x": "2 m", "y": "0 m"}, {"x": "2.2 m", "y": "0 m"}, {"x": "2.4 m", "y": "0.1 m"}],
    },
}


@dataclass(frozen=True)
class Done:
    """A run that is over."""

    finished: Finished
    rested: bool
    """Whether the robot stood still when it was released."""

    @property
    def outcome(self) -> str:
        return str(self.finished.result.outcome)

    @property
    def rows(self) -> dict[str, FaultStages]:
        """What became of each fault, by its name."""
        return {row.name: row for row in self.finished.result.faults}

    @cached_property
    def record(self) -> History:
        return History.of(self.finished.folder / "record.mcap")

    def times(self, device: str, verb: str) -> list[float]:
        """When a device was told to do something [s]."""
        commands = self.record.all(events.Command)
        return [at.time_s for at in commands if (at.event.device, at.event.verb) == (device, verb)]

    def breaches(self) -> list[str]:
        """Every promise of a run's end that was not kept."""
        folder, stop = self.finished.folder, self.record.last(events.Stop)
        result = read_result(folder / "result.json")
        drives, stops = self.times("tracks", "drive"), self.times("tracks", "stop")
        promises = {
            "the record is closed": is_complete(folder / "record.mcap"),
            "the record ends with a stop": stop is not None and stop.event.outcome == self.outcome,
            "the rover rests": self.rested,
            "the drives are stopped": not drives or bool(stops and stops[-1] >= drives[-1]),
            "the result is of this run": result == self.finished.result,
            "a defect is told": (folder / "traceback.txt").is_file() == (self.outcome == "error"),
            "the report is there": (folder / "report.html").is_file(),
        }
        return [promise for promise, kept in promises.items() if not kept]


def write(folder: Path, *faults: dict[str, Any], **head: Any) -> Path:
    """The scenario file."""
    file = folder / "short.yaml"
    file.write_text(json.dumps(HEAD | head | {"faults": list(faults)}))
    return file


def run(folder: Path, *faults: dict[str, Any], **head: Any) -> Done:
    """Run the short mission with these faults."""
    moving: list[bool] = []
    with patch.object(FakeBackend, "close", lambda backend: moving.append(backend.robot.moving)):
        finished = run_file(write(folder, *faults, **head), RunOptions(out=folder / "run", bar=False))
    return Done(finished, rested=moving == [False])


def complaint(folder: Path, capsys: Any, *faults: dict[str, Any]) -> str:
    """What is said of a scenario that cannot be run."""
    assert invoke(["run", str(write(folder, *faults)), "--out", str(folder / "run")]) == 2
    return str(capsys.readouterr().err)
