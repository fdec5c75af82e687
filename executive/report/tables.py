"""The report's tables, as rows of plain text."""

from __future__ import annotations

import math
from dataclasses import dataclass

from executive.core.types import Call
from executive.record.events import WaypointEvent
from executive.record.result import waypoint_error_m
from executive.record.rows import JudgedRow, worst_first
from executive.report.figure import duration, millimetres
from executive.report.gather import RecordedRun
from executive.report.injected import numbers
from executive.report.overview import letter


@dataclass(frozen=True)
class Table:
    """A table: header and rows of text; `folded` starts closed."""

    key: str
    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    folded: bool = False


def tables(run: RecordedRun) -> list[Table]:
    """Every table that has rows."""
    kinds = (waypoints, strategies, faults, expectations, safety, calls, localisations)
    return [table for kind in kinds if (table := kind(run)).rows]


def waypoints(run: RecordedRun) -> Table:
    rows = []
    for at in run.history.all(WaypointEvent):
        event = at.event
        believed = math.hypot(event.pose.x_m - event.target.x_m, event.pose.y_m - event.target.y_m)
        tolerance = next((s.tolerance_m for s in run.segments if s.end == event.target), None)
        true = None if run.track is None else waypoint_error_m(run.track, at)
        inside = "–" if true is None or tolerance is None else "yes" if true <= tolerance else "NO"
        rows.append(
            (
                str(event.index),
                f"{event.target.x_m:.3f}, {event.target.y_m:.3f}",
                duration(at.time_s),
                millimetres(believed),
                millimetres(true),
                millimetres(tolerance, 0),
                inside,
            )
        )
    header = ("way-point", "x, y [m]", "reached at", "believed error", "true error", "tolerance", "inside")
    return Table("waypoints", "Way-points", header, tuple(rows))


def strategies(run: RecordedRun) -> Table:
    rows = tuple(
        (
            letter(n),
            row.name,
            duration(row.t_s),
            row.hypothesis,
            f"{row.weight:.2f}",
            {True: "yes", False: "no", None: "–"}[row.helped],
            row.why,
        )
        for n, row in enumerate(run.result.strategies)
    )
    header = ("", "strategy", "chosen at", "against", "weight", "helped", "why")
    return Table("strategies", "Strategies", header, rows)


FAULT_STAGES = ("armed", "on", "observable", "detected", "isolated", "recovered", "off")


def faults(run: RecordedRun) -> Table:
    number = numbers(run)
    rows = tuple(
        (
            number[row.name],
            row.name,
            *(_time(getattr(row, f"t_{stage}_s")) for stage in FAULT_STAGES),
            row.hypothesis or "–",
            row.expected or "–",
        )
        for row in run.result.faults
    )
    note = (
        "Armed when its onset came, fired when it altered something; the run is invalid where it never did."
    )
    stages = ("armed", "fired", "observable", "detected", "isolated", "recovered", "ended")
    header = ("", "fault", *stages, "concluded", "expected")
    return Table("faults", "Injected faults", header, rows, note if rows else "")


def expectations(run: RecordedRun) -> Table:
    rows = tuple(_judged(row) for row in worst_first(run.result.expectations))
    note = (
        "Robustness is the distance to the limit, negative where it is not met; flags and yes-or-no "
        "expectations have none. An expectation is violated from when it was certain to fail. "
        "What is not met comes first, the earliest first."
    )
    return Table("expectations", "Expectations", ("expectation", *_JUDGED), rows, note if rows else "")


def safety(run: RecordedRun) -> Table:
    rows = tuple(_judged(row) for row in run.result.safety or ())
    note = "These must hold of every run, whatever fails and whatever its scenario expects."
    return Table("safety", "Safety", ("whatever happens", *_JUDGED), rows, note if rows else "")


_JUDGED = ("", "robustness", "violated from", "warning")


def _judged(row: JudgedRow) -> tuple[str, ...]:
    verdict = {True: "met", False: "NOT MET", None: "not known"}[row.met]
    margin = f"{_plain(row.robustness)} {row.unit or ''}".rstrip()
    return row.text, verdict, margin, _time(row.t_violation_s), row.warning or ""


def calls(run: RecordedRun) -> Table:
    rows = tuple(
        (
            duration(time_s),
            call.reason.value,
            call.detail,
            ", ".join(f"{k} {v:.3g}" for k, v in call.evidence.items()),
        )
        for time_s, call in run.history.all(Call)
    )
    return Table("calls", "Calls to ground", ("at", "reason", "detail", "evidence"), rows)


def localisations(run: RecordedRun) -> Table:
    rows = []
    for n, pose in enumerate(run.fixes, start=1):
        error = run.errors[n - 1] if run.errors else None
        rows.append(
            (
                str(n),
                duration(pose.time_s),
                f"{pose.x_m:.4f}",
                f"{pose.y_m:.4f}",
                f"{pose.position_site_m[2]:.4f}",
                f"{math.degrees(pose.heading_rad):.2f}",
                str(pose.markers),
                millimetres(pose.sigma_position_m, 2),
                f"{math.degrees(pose.sigma_heading_rad):.3f}",
                "–" if error is None else millimetres(math.hypot(*error.position_m), 2),
                "–" if error is None else f"{math.degrees(error.rotation_rad[2]):+.3f}",
                "–" if error is None else f"{error.nees:.1f}",
            )
        )
    header: tuple[str, ...] = ("", "at", "x [m]", "y [m]", "z [m]", "heading [deg]", "markers")
    header += ("σ position", "σ heading [deg]", "true error", "yaw error [deg]", "NEES")
    note = "NEES is the squared error in units of its covariance, 6 components: 6 on average if consistent."
    return Table("localisations", "Every localisation", header, tuple(rows), note, folded=True)


def _time(seconds: float | None) -> str:
    return "–" if seconds is None else duration(seconds)


def _plain(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"
