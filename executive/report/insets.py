"""Close views of each way-point, where millimetres matter."""

from __future__ import annotations

import numpy as np

from executive.record.events import WaypointEvent
from executive.record.history import At
from executive.record.result import waypoint_error_m
from executive.report import layers, palette, svg
from executive.report.figure import Figure, millimetres
from executive.report.frame import MapFrame
from executive.report.gather import RecordedRun

_SIDE = 250.0


def insets(run: RecordedRun) -> Figure | None:
    """One square per way-point that was declared reached."""
    reached = run.history.all(WaypointEvent)
    if not reached:
        return None
    cards = "".join(_card(run, at) for at in reached)
    caption = (
        "The last centimetres before each way-point, all at true scale: tolerance zone (green ring), "
        "localisations with their 2σ ellipses (orange), believed track (blue, dashed)"
        + (", true track (black)" if run.track else "")
        + ". The cross is the way-point"
        + (
            "; the black dot is where the rover truly stood when it declared it reached."
            if run.track
            else "."
        )
    )
    return Figure("insets", "At the way-points", f"<div class='cards'>{cards}</div>", caption)


def _card(run: RecordedRun, at: At[WaypointEvent]) -> str:
    target = at.event.target
    tolerance = next((s.tolerance_m for s in run.segments if s.end == target), 0.03)
    off = 0.0 if run.track is None else waypoint_error_m(run.track, at)
    half = max(1.6 * tolerance, 1.3 * off)
    frame = MapFrame(
        target.x_m - half, target.y_m - half, target.x_m + half, target.y_m + half, _SIDE / (2 * half)
    )
    clip = f"inset-{at.event.index}-{round(at.time_s)}"
    stood = _stood(run, at, frame)
    body = [
        svg.element("clipPath", svg.element("rect", width=_SIDE, height=_SIDE), id=clip),
        svg.element(
            "g",
            svg.element("rect", width=_SIDE, height=_SIDE, fill="#f3efe7"),
            layers.plan(run, frame),
            layers.zones(run, frame),
            layers.believed_track(run, frame, 1.6),
            layers.true_track(run.track, frame, 2.2) if run.track else "",
            layers.fixes(run, frame, 2.0, 2.6),
            svg.element("path", d=f"M{_SIDE / 2 - 8} {_SIDE / 2}h16m-8 -8v16", class_="cross"),
            stood,
            layers.scale_bar(frame, 16, _SIDE - 14),
            clip_path=f"url(#{clip})",
        ),
    ]
    error = millimetres(off) if run.track else "unknown"
    allowed = f"{tolerance * 1000:.0f} mm allowed"
    words = f"way-point {at.event.index}<br><span>true error <b>{error}</b>, {allowed}</span>"
    return f"<div class='card'>{svg.drawing(_SIDE, _SIDE, body)}<p>{words}</p></div>"


def _stood(run: RecordedRun, at: At[WaypointEvent], frame: MapFrame) -> str:
    if run.track is None:
        return ""
    x_m, y_m = np.asarray(run.track.position(at.time_s))[:2]
    return svg.element(
        "circle",
        cx=frame.x(float(x_m)),
        cy=frame.y(float(y_m)),
        r=4.5,
        fill=palette.TRUTH,
        stroke="#fff",
        stroke_width=1.2,
    )
