"""`result.json` from the record, the truth where there is one, and the wall figures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from executive.core.types import PoseEstimate, Reason
from executive.record.digest import digest
from executive.record.events import (
    NodeChange,
    Resumed,
    RouteEvent,
    SegmentEvent,
    Start,
    Stop,
    StrategyEvent,
    Verdict,
    WaypointEvent,
)
from executive.record.evidence import false_alarms, fault_rows
from executive.record.history import At, History
from executive.record.run_result import (
    Localisations,
    RunResult,
    StrategyRow,
    TrueFigures,
    Waypoints,
)
from executive.record.truth import (
    PoseError,
    Track,
    cross_track,
    driven_beyond_m,
)

NO_STOP = "the record ends without a stop"
VISION_REASONS = frozenset({Reason.NOT_SEEN, Reason.POOR_VIEW, Reason.UNSTABLE_IMAGES, Reason.IMPLAUSIBLE})


@dataclass(frozen=True)
class RunFigures:
    """What the record cannot know: wall time [s] in all and by part, and the way-points of the mission."""

    wall_s: float | None = None
    wall: Mapping[str, float] = field(default_factory=dict)
    waypoints_total: int | None = None


def summarise(record: Path, truth: Path | None, figures: RunFigures | None = None) -> RunResult:
    """The content of `result.json`. Without truth, or where a measure is not defined, its value is None.

    RecordError if there is no record.
    """
    history = History.of(record)
    world = History.of(truth) if truth is not None and truth.is_file() else History.empty()
    return summary_of(history, world, digest(record), figures or RunFigures())


def summary_of(history: History, world: History, content: str, figures: RunFigures) -> RunResult:
    """The same from what was read already; `content` is the digest of the record."""
    track = Track.of(world)
    start, stop = history.last(Start), history.last(Stop)
    faults = fault_rows(history, world)
    result = RunResult(
        scenario=start.event.scenario if start else None,
        seed=start.event.seed if start else None,
        tier=start.event.tier if start else None,
        digest=content,
        outcome=stop.event.outcome if stop else "error",
        reason=stop.event.reason if stop else NO_STOP,
        mission_s=history.end_s,
        wall_s=figures.wall_s,
        wall=dict(figures.wall),
        waypoints=_waypoints(history, figures.waypoints_total),
        truth=TrueFigures() if track is None else _truth(history, track),
        localisation=_localisation(history, track),
        strategies=strategy_rows(history),
        faults=faults,
        false_alarms=false_alarms(history, faults),
        resumed_s=tuple(at.time_s for at in history.all(Resumed)),
    )
    return RunResult.from_json(result.to_json())  # what is no number is None, here as in the file


def _waypoints(history: History, total: int | None) -> Waypoints:
    route = history.last(RouteEvent)
    planned = len(route.event.segments) if route else 0
    reached = {at.event.index for at in history.all(WaypointEvent)}
    return Waypoints(planned if total is None else total, len(reached))


def waypoint_error_m(track: Track, at: At[WaypointEvent]) -> float:
    """True horizontal distance to the way-point when the executive declared it reached [m]."""
    x_m, y_m, _ = track.position(at.time_s)
    return math.hypot(x_m - at.event.target.x_m, y_m - at.event.target.y_m)


def _truth(history: History, track: Track) -> TrueFigures:
    cross = cross_track(track, history.all(SegmentEvent))
    known = np.abs(cross.cross_m[np.isfinite(cross.cross_m)])
    return TrueFigures(
        final_error_m=_final_error_m(history, track),
        waypoint_errors_m=tuple(waypoint_error_m(track, at) for at in history.all(WaypointEvent)),
        max_cross_track_m=float(known.max()) if known.size else None,
        driven_beyond_off_track_m=float(driven_beyond_m(track, cross)[-1]),
        max_tilt_deg=math.degrees(track.tilt_rad().max()),
        path_m=float(track.steps_m().sum()),
        tether_max_n=float(track.tether_n.max()),
    )


def _final_error_m(history: History, track: Track) -> float | None:
    """True horizontal distance from where the rover stands at the end to the last way-point of the plan."""
    route = history.last(RouteEvent)
    if route is None or not route.event.segments:
        return None
    goal = route.event.segments[-1].end
    x_m, y_m, _ = track.position_site_m[-1]
    return math.hypot(x_m - goal.x_m, y_m - goal.y_m)


def pose_errors(history: History, track: Track) -> list[PoseError]:
    """Truth minus estimate for every vision fix."""
    return [PoseError.of(track, pose) for pose in vision_fixes(history)]


def vision_fixes(history: History) -> list[PoseEstimate]:
    """The precise localisations, in order of time."""
    return [at.event for at in history.all(PoseEstimate) if at.event.is_fix]


def _localisation(history: History, track: Track | None) -> Localisations:
    errors = pose_errors(history, track) if track is not None else []
    failed = len(failed_localisations(history))
    count = len(vision_fixes(history)) + failed
    if not errors:
        return Localisations(count, failed)
    return Localisations(
        count,
        failed,
        position_rmse_m=math.sqrt(float(np.mean([e.position_m @ e.position_m for e in errors]))),
        yaw_rmse_deg=math.degrees(math.sqrt(np.mean([e.rotation_rad[2] ** 2 for e in errors]))),
        nees_mean=float(np.mean([e.nees for e in errors])),
    )


def failed_localisations(history: History) -> list[At[NodeChange]]:
    """The ends of leaves that failed for a reason of vision; composites that pass it on do not count."""
    changes = history.all(NodeChange)
    parents = {prefix for at in changes for prefix in _parents(at.event.path)}
    reasons = {reason.value for reason in VISION_REASONS}
    return [at for at in changes if at.event.reason in reasons and at.event.path not in parents]


def _parents(path: str) -> list[str]:
    parts = path.split("/")
    return ["/".join(parts[:n]) for n in range(1, len(parts))]


def strategy_rows(history: History) -> tuple[StrategyRow, ...]:
    """One row per strategy chosen, in the order of their choice."""
    rows: list[StrategyRow] = []
    for time_s, event in history.all(StrategyEvent):
        if event.verdict is Verdict.CHOSEN:
            chosen = (event.name, time_s, event.hypothesis, event.weight, event.attempt)
            rows.append(StrategyRow(*chosen, why=event.why))
            continue
        asked = [i for i, row in enumerate(rows) if row.name == event.name and row.helped is None]
        if asked:
            helped = event.verdict is Verdict.HELPED
            rows[asked[-1]] = replace(rows[asked[-1]], helped=helped, t_end_s=time_s)
    return tuple(rows)
