"""`result.json` from the record, the truth where there is one, and the wall figures."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from executive.core.types import PoseEstimate, Reason
from executive.record.digest import digest
from executive.record.events import (
    NodeChange,
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
from executive.record.truth import (
    PoseError,
    Track,
    cross_track,
    driven_beyond_m,
)

SCHEMA = 1
NO_STOP = "the record ends without a stop"
VISION_REASONS = frozenset({Reason.NOT_SEEN, Reason.POOR_VIEW, Reason.UNSTABLE_IMAGES, Reason.IMPLAUSIBLE})
_TRUTH_KEYS = (
    "final_error_m",
    "waypoint_errors_m",
    "max_cross_track_m",
    "driven_beyond_off_track_m",
    "max_tilt_deg",
    "path_m",
    "tether_max_n",
)


@dataclass(frozen=True)
class RunFigures:
    """What the record cannot know: wall time [s] in all and by part, and how the expectations came out."""

    wall_s: float | None = None
    wall: Mapping[str, float] = field(default_factory=dict)
    expectations: Sequence[Mapping[str, object]] = ()
    waypoints_total: int | None = None


def summarise(record: Path, truth: Path | None, figures: RunFigures | None = None) -> dict[str, object]:
    """The content of `result.json`. Without truth, or where a measure is not defined, its value is None.

    RecordError if there is no record.
    """
    history = History.of(record)
    world = History.of(truth) if truth is not None and truth.is_file() else History.empty()
    return summary_of(history, world, digest(record), figures or RunFigures())


def summary_of(history: History, world: History, content: str, figures: RunFigures) -> dict[str, object]:
    """The same from what was read already; `content` is the digest of the record."""
    track = Track.of(world)
    faults = fault_rows(history, world)
    summary = {
        "schema": SCHEMA,
        **_identity(history, content),
        "wall_s": figures.wall_s,
        "wall": dict(figures.wall),
        "waypoints": _waypoints(history, figures.waypoints_total),
        "truth": dict.fromkeys(_TRUTH_KEYS) if track is None else _truth(history, track),
        "localisation": _localisation(history, track),
        "strategies": strategy_rows(history),
        "faults": faults,
        "false_alarms": false_alarms(history, faults),
        "expectations": [dict(e) for e in figures.expectations],
    }
    return {key: _strict(value) for key, value in summary.items()}


def write_result(path: Path, summary: Mapping[str, object]) -> None:
    """Write strictly valid JSON, with a newline at the end."""
    path.write_text(json.dumps(summary, indent=2, allow_nan=False) + "\n")


def _identity(history: History, content: str) -> dict[str, object]:
    start, stop = history.last(Start), history.last(Stop)
    return {
        "scenario": start.event.scenario if start else None,
        "seed": start.event.seed if start else None,
        "tier": start.event.tier if start else None,
        "digest": content,
        "outcome": stop.event.outcome if stop else "error",
        "reason": stop.event.reason if stop else NO_STOP,
        "mission_s": history.end_s,
    }


def _waypoints(history: History, total: int | None) -> dict[str, object]:
    route = history.last(RouteEvent)
    planned = len(route.event.segments) if route else 0
    reached = {at.event.index for at in history.all(WaypointEvent)}
    return {"total": planned if total is None else total, "reached": len(reached)}


def waypoint_error_m(track: Track, at: At[WaypointEvent]) -> float:
    """True horizontal distance to the way-point when the executive declared it reached [m]."""
    x_m, y_m, _ = track.position(at.time_s)
    return math.hypot(x_m - at.event.target.x_m, y_m - at.event.target.y_m)


def _truth(history: History, track: Track) -> dict[str, object]:
    cross = cross_track(track, history.all(SegmentEvent))
    known = np.abs(cross.cross_m[np.isfinite(cross.cross_m)])
    return {
        "final_error_m": _final_error_m(history, track),
        "waypoint_errors_m": [waypoint_error_m(track, at) for at in history.all(WaypointEvent)],
        "max_cross_track_m": float(known.max()) if known.size else None,
        "driven_beyond_off_track_m": float(driven_beyond_m(track, cross)[-1]),
        "max_tilt_deg": math.degrees(track.tilt_rad().max()),
        "path_m": float(track.steps_m().sum()),
        "tether_max_n": float(track.tether_n.max()),
    }


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


def _localisation(history: History, track: Track | None) -> dict[str, object]:
    errors = pose_errors(history, track) if track is not None else []
    failed = len(failed_localisations(history))
    figures: dict[str, object] = {
        "count": len(vision_fixes(history)) + failed,
        "failed": failed,
        "position_rmse_m": None,
        "yaw_rmse_deg": None,
        "nees_mean": None,
    }
    if errors:
        squares = [e.position_m @ e.position_m for e in errors]
        figures["position_rmse_m"] = math.sqrt(float(np.mean(squares)))
        figures["yaw_rmse_deg"] = math.degrees(math.sqrt(np.mean([e.rotation_rad[2] ** 2 for e in errors])))
        figures["nees_mean"] = float(np.mean([e.nees for e in errors]))
    return figures


def failed_localisations(history: History) -> list[At[NodeChange]]:
    """The ends of leaves that failed for a reason of vision; composites that pass it on do not count."""
    changes = history.all(NodeChange)
    parents = {prefix for at in changes for prefix in _parents(at.event.path)}
    reasons = {reason.value for reason in VISION_REASONS}
    return [at for at in changes if at.event.reason in reasons and at.event.path not in parents]


def _parents(path: str) -> list[str]:
    parts = path.split("/")
    return ["/".join(parts[:n]) for n in range(1, len(parts))]


def strategy_rows(history: History) -> list[dict[str, object]]:
    """One row per strategy chosen; `helped` None where the verdict is still out."""
    rows: list[dict[str, object]] = []
    for time_s, event in history.all(StrategyEvent):
        if event.verdict is Verdict.CHOSEN:
            rows.append(_strategy_row(time_s, event))
            continue
        asked = [row for row in rows if row["name"] == event.name and row["helped"] is None]
        if asked:
            asked[-1]["helped"] = event.verdict is Verdict.HELPED
            asked[-1]["t_end_s"] = time_s
    return rows


def _strategy_row(time_s: float, event: StrategyEvent) -> dict[str, object]:
    return {
        "name": event.name,
        "t_s": time_s,
        "hypothesis": event.hypothesis,
        "weight": event.weight,
        "attempt": event.attempt,
        "helped": None,
        "t_end_s": None,
        "why": event.why,
    }


def _strict(value: object) -> object:
    """The same with what JSON cannot say (NaN, infinities) as None."""
    if isinstance(value, dict):
        return {key: _strict(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_strict(inner) for inner in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
