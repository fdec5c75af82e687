"""The key figures at the head of the report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from executive.record import RunResult
from executive.report.figure import duration, millimetres

_TONES = {"reached": "good", "safe_hold": "care", "help": "care"}


@dataclass(frozen=True)
class Tile:
    """One figure: what it is, its value, a remark, and a tone (good, care, bad, or none)."""

    label: str
    value: str
    remark: str = ""
    tone: str = ""


def tone_of(outcome: str) -> str:
    """How an outcome is coloured."""
    return _TONES.get(outcome, "bad")


def tiles(result: RunResult) -> list[Tile]:
    """The figures of `result.json` that say how the run went."""
    truth, seen, points = result.truth, result.localisation, result.waypoints
    beyond_m = truth.driven_beyond_off_track_m
    errors = [e for e in truth.waypoint_errors_m or () if e is not None]
    return [
        Tile("way-points", f"{points.reached} of {points.total}", "declared reached"),
        Tile("final error", millimetres(truth.final_error_m), "true, to the last way-point"),
        Tile("worst way-point", millimetres(max(errors, default=None)), "true error when declared"),
        Tile("largest cross-track", millimetres(truth.max_cross_track_m), "true"),
        Tile(
            "beyond off-track",
            millimetres(beyond_m, 0),
            "true way driven",
            "" if beyond_m is None else "bad" if beyond_m > 0 else "good",
        ),
        Tile("way driven", _format(truth.path_m, "{:.2f} m"), f"in {duration(result.mission_s)}"),
        Tile("localisations", str(seen.count), f"{seen.failed} failed"),
        Tile("position error", millimetres(seen.position_rmse_m), "RMS of localisations"),
        Tile("heading error", _format(seen.yaw_rmse_deg, "{:.2f}°"), "RMS of localisations"),
        Tile("NEES", _format(seen.nees_mean, "{:.1f}"), "mean; 6 if consistent"),
        Tile("largest tilt", _format(truth.max_tilt_deg, "{:.1f}°"), "true"),
        Tile("wall time", _format(result.wall_s, "{:.1f} s"), _parts(result.wall)),
    ]


def _format(value: float | None, pattern: str) -> str:
    return "–" if value is None else pattern.format(value)


def _parts(wall: Mapping[str, float | None]) -> str:
    """The two parts that took longest."""
    longest = sorted(((seconds or 0.0, part) for part, seconds in wall.items()), reverse=True)[:2]
    return ", ".join(f"{part} {seconds:.1f}" for seconds, part in longest)
