"""Everything a report is made from, read once; what is missing is named, not raised."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from executive.core.errors import RecordError
from executive.core.types import PoseEstimate, PoseSource, Segment
from executive.record import History, RunResult, read_result, summarise
from executive.record.events import RouteEvent, SegmentEvent, Start
from executive.record.result import vision_fixes
from executive.record.truth import (
    CrossTrack,
    PoseError,
    Track,
    cross_track,
)


@dataclass(frozen=True, eq=False)
class RecordedRun:
    """A run as the report sees it. `missing` holds a sentence per thing that is not there."""

    folder: Path
    scenario_yaml: str
    result: RunResult
    history: History
    world: History
    missing: tuple[str, ...]

    @cached_property
    def track(self) -> Track | None:
        return Track.of(self.world)

    @cached_property
    def fixes(self) -> list[PoseEstimate]:
        """The vision fixes, in order of time."""
        return vision_fixes(self.history)

    @cached_property
    def estimates(self) -> list[PoseEstimate]:
        """What the executive believed, in order of time; a motion tendency is only watched."""
        every = (at.event for at in self.history.all(PoseEstimate))
        return [p for p in every if p.source != PoseSource.TREND and np.isfinite(p.position_site_m).all()]

    @cached_property
    def errors(self) -> list[PoseError] | None:
        """Truth minus estimate per fix, None without truth."""
        track = self.track
        return None if track is None else [PoseError.of(track, pose) for pose in self.fixes]

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """The plan: as uplinked if recorded, else the segments that were begun."""
        route = self.history.last(RouteEvent)
        if route is not None:
            return route.event.segments
        begun = [at.event.segment for at in self.history.all(SegmentEvent) if at.event.segment is not None]
        return tuple(dict.fromkeys(begun))

    @cached_property
    def cross(self) -> CrossTrack | None:
        """True cross-track error, None without truth."""
        track = self.track
        return None if track is None else cross_track(track, self.history.all(SegmentEvent))

    @property
    def end_s(self) -> float:
        """Mission time at which the record ends [s]; never 0, so that it can be divided by."""
        return max(self.history.end_s, 1.0)

    def believed_at(self, time_s: float) -> PoseEstimate | None:
        """The last estimate at or before a mission time."""
        times = [pose.time_s for pose in self.estimates]
        index = int(np.searchsorted(times, time_s, side="right")) - 1
        return self.estimates[index] if index >= 0 else None


def gather(folder: Path) -> RecordedRun:
    """Read a run folder. RecordError only if the folder itself is not there."""
    if not folder.is_dir():
        raise RecordError(f"{folder}: no such run folder")
    missing: list[str] = []
    record, truth = folder / "record.mcap", folder / "truth.mcap"
    history = _history(record, "no record: the run left nothing to report on", missing)
    if record.is_file() and not history.complete:
        missing.append(f"record.mcap was cut off: it reads up to {history.end_s:.0f} s of mission time")
    world = _history(truth, "no truth: true errors cannot be given, only what the rover believed", missing)
    scenario = folder / "scenario.yaml"
    text = scenario.read_text() if scenario.is_file() else _recorded_scenario(history)
    if not scenario.is_file():
        instead = "the copy in the record is shown" if text else "the run cannot be repeated from here"
        missing.append(f"scenario.yaml: not there; {instead}")
    return RecordedRun(folder, text, _result(folder, missing), history, world, tuple(missing))


def _recorded_scenario(history: History) -> str:
    start = history.last(Start)
    return start.event.scenario_yaml if start is not None else ""


def _history(path: Path, otherwise: str, missing: list[str]) -> History:
    if not path.is_file():
        missing.append(f"{path.name}: {otherwise}")
        return History.empty()
    return History.of(path)


def _result(folder: Path, missing: list[str]) -> RunResult:
    """The result as written; computed anew from the record where it was not, empty where nothing is left."""
    path, record = folder / "result.json", folder / "record.mcap"
    if path.is_file():
        try:
            return read_result(path)
        except RecordError:
            missing.append("result.json cannot be read: figures are computed anew from the record")
    else:
        missing.append("result.json: not written; figures are computed anew from the record")
    return summarise(record, folder / "truth.mcap") if record.is_file() else RunResult()
