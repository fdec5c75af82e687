"""A small map of one case: plan, margins, true and believed track, over the terrain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from executive.core.errors import RecordError
from executive.record.events import TerrainEvent
from executive.report import layers, palette, svg
from executive.report.frame import MapFrame, corridor
from executive.report.gather import RecordedRun, gather
from executive.report.relief import shaded
from proving.campaign_report.case import RecordedCase

WIDTH, HEIGHT = 340.0, 210.0
_RELIEF_PX = 150


def thumbnail(case: RecordedCase) -> str:
    """The map as SVG; a sentence where the case left no record to draw."""
    try:
        run = gather(case.folder)
    except RecordError:
        return _nothing()
    frame = _frame(run)
    if frame is None:
        return _nothing()
    clip = f"thumb-{case.index}"
    inside = [
        _ground(run, frame),
        layers.plan(run, frame),
        layers.zones(run, frame),
        layers.believed_track(run, frame, 1.3),
        layers.true_track(run.track, frame, 1.8) if run.track else "",
        _end(run, frame),
        layers.scale_bar(frame, 14, HEIGHT - 12),
    ]
    box = svg.element("clipPath", svg.element("rect", width=WIDTH, height=HEIGHT), id=clip)
    drawn = [box, svg.element("g", *inside, clip_path=f"url(#{clip})")]
    return svg.drawing(WIDTH, HEIGHT, drawn, class_="map", aria_label=f"Map of case {case.index}")


def _nothing() -> str:
    words = svg.text(WIDTH / 2, HEIGHT / 2, "no record was left", class_="tick mid")
    return svg.drawing(WIDTH, HEIGHT, [words], class_="map", aria_label="no map")


def _frame(run: RecordedRun) -> MapFrame | None:
    """The frame that holds the corridor and the tracks, centred in the card."""
    xy = [p for s in run.segments for p in corridor(s, s.off_track_m)]
    xy += [(p.x_m, p.y_m) for p in run.estimates]
    if run.track is not None:
        xy += [(float(x), float(y)) for x, y in run.track.position_site_m[::20, :2]]
    if not xy:
        return None
    low, high = np.min(xy, axis=0) - 0.08, np.max(xy, axis=0) + 0.08
    scale = float(min(WIDTH / (high[0] - low[0]), HEIGHT / (high[1] - low[1])))
    (x, y), half_x, half_y = (low + high) / 2, WIDTH / scale / 2, HEIGHT / scale / 2
    return MapFrame(x - half_x, y - half_y, x + half_x, y + half_y, scale)


def _ground(run: RecordedRun, frame: MapFrame) -> str:
    """The terrain cut to the frame and shaded coarsely: a page holds a dozen of these."""
    plain = svg.element("rect", width=WIDTH, height=HEIGHT, fill="#efeae0")
    found = run.history.last(TerrainEvent) or run.world.last(TerrainEvent)
    if found is None:
        return plain
    cut = _cut(found.event, frame)
    if min(cut.elevation_m.shape) < 3:
        return plain
    rows, columns = cut.elevation_m.shape
    picture = svg.element(
        "image",
        href=shaded(cut, _RELIEF_PX),
        x=frame.x(cut.origin_m[0] - cut.step_m / 2),
        y=frame.y(cut.origin_m[1] + (rows - 0.5) * cut.step_m),
        width=columns * cut.step_m * frame.px_per_m,
        height=rows * cut.step_m * frame.px_per_m,
        preserveAspectRatio="none",
    )
    return plain + picture + layers.rocks(cut, frame)


def _cut(terrain: TerrainEvent, frame: MapFrame) -> TerrainEvent:
    """The cells of the grid that lie in the frame, with one to spare."""
    step, (x0, y0) = terrain.step_m, terrain.origin_m
    rows, columns = terrain.elevation_m.shape
    left, right = _range(frame.x0_m - x0, frame.x1_m - x0, step, columns)
    low, high = _range(frame.y0_m - y0, frame.y1_m - y0, step, rows)
    return replace(
        terrain,
        origin_m=(x0 + left * step, y0 + low * step),
        elevation_m=terrain.elevation_m[low:high, left:right],
    )


def _range(start_m: float, end_m: float, step_m: float, count: int) -> tuple[int, int]:
    return max(0, int(start_m / step_m) - 1), min(count, int(end_m / step_m) + 3)


def _end(run: RecordedRun, frame: MapFrame) -> str:
    """The way-points, and where the rover truly came to stand."""
    goals = "".join(
        svg.element("circle", cx=frame.x(s.end.x_m), cy=frame.y(s.end.y_m), r=1.8, fill=palette.INK)
        for s in run.segments
    )
    if run.track is None:
        return goals
    x_m, y_m = (float(v) for v in run.track.position_site_m[-1, :2])
    dot = svg.element(
        "circle", cx=frame.x(x_m), cy=frame.y(y_m), r=4.2, fill=palette.BAD, stroke="#fff", stroke_width=1.2
    )
    return goals + dot
