"""The key figures at the head of the report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

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


def tiles(result: Mapping[str, Any]) -> list[Tile]:
    """The figures of `result.json` that say how the run went."""
    truth, seen = result.get("truth") or {}, result.get("localisation") or {}
    reached = result.get("waypoints") or {"reached": 0, "total": 0}
    beyond = truth.get("driven_beyond_off_track_m")
    errors = [e for e in truth.get("waypoint_errors_m") or [] if e is not None]
    return [
        Tile("way-points", f"{reached['reached']} of {reached['total']}", "declared reached"),
        Tile("final error", millimetres(truth.get("final_error_m")), "true, to the last way-point"),
        Tile("worst way-point", millimetres(max(errors, default=None)), "true error when declared"),
        Tile("largest cross-track", millimetres(truth.get("max_cross_track_m")), "true"),
        Tile(
            "beyond off-track",
            millimetres(beyond, 0),
            "true way driven",
            "" if beyond is None else "bad" if beyond > 0 else "good",
        ),
        Tile("way driven", _format(truth.get("path_m"), "{:.2f} m"), f"in {_mission(result)}"),
        Tile("localisations", str(seen.get("count", 0)), f"{seen.get('failed', 0)} failed"),
        Tile("position error", millimetres(seen.get("position_rmse_m")), "RMS of localisations"),
        Tile("heading error", _format(seen.get("yaw_rmse_deg"), "{:.2f}°"), "RMS of localisations"),
        Tile("NEES", _format(seen.get("nees_mean"), "{:.1f}"), "mean; 6 if consistent"),
        Tile("largest tilt", _format(truth.get("max_tilt_deg"), "{:.1f}°"), "true"),
        Tile("wall time", _format(result.get("wall_s"), "{:.1f} s"), _parts(result.get("wall") or {})),
    ]


def _mission(result: Mapping[str, Any]) -> str:
    return duration(result.get("mission_s") or 0.0)


def _format(value: float | None, pattern: str) -> str:
    return "–" if value is None else pattern.format(value)


def _parts(wall: Mapping[str, float | None]) -> str:
    """The two parts that took longest."""
    longest = sorted(((s or 0.0, part) for part, s in wall.items()), reverse=True)[:2]
    return ", ".join(f"{part} {seconds:.1f}" for seconds, part in longest)
