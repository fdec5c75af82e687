"""What is drawn on a map, layer by layer; the overview and the way-point insets share these."""

from __future__ import annotations

import math

import numpy as np

from executive.core.rig import RoverCalibration
from executive.core.types import Array
from executive.record.events import TerrainEvent
from executive.record.truth import Track
from executive.report import palette, svg
from executive.report.axes import ticks
from executive.report.frame import MapFrame, corridor, ellipse, outline
from executive.report.gather import RecordedRun
from executive.report.relief import shaded


def ground(run: RecordedRun, frame: MapFrame) -> str:
    """Hill-shaded terrain and rocks; a plain tone where there is no elevation map."""
    plain = svg.element(
        "rect", x=frame.left_px, y=frame.top_px, width=frame.width_px, height=frame.height_px, fill="#efeae0"
    )
    found = run.history.last(TerrainEvent) or run.world.last(TerrainEvent)
    if found is None:
        return plain
    terrain = found.event
    rows, columns = terrain.elevation_m.shape
    half = terrain.step_m / 2  # a grid value is the middle of its cell
    x0, y0 = terrain.origin_m[0] - half, terrain.origin_m[1] - half
    picture = svg.element(
        "image",
        href=shaded(terrain),
        x=frame.x(x0),
        y=frame.y(y0 + rows * terrain.step_m),
        width=columns * terrain.step_m * frame.px_per_m,
        height=rows * terrain.step_m * frame.px_per_m,
        preserveAspectRatio="none",
    )
    return plain + picture + rocks(terrain, frame)


def rocks(terrain: TerrainEvent, frame: MapFrame) -> str:
    """Rocks as discs with a shaded rim."""
    return "".join(
        svg.element(
            "circle",
            svg.title(f"rock, radius {rock.radius_m * 1000:.0f} mm"),
            cx=frame.x(rock.x_m),
            cy=frame.y(rock.y_m),
            r=max(rock.radius_m * frame.px_per_m, 1.5),
            fill="#8d8172",
            fill_opacity=0.85,
            stroke="#5f564a",
            stroke_width=1,
        )
        for rock in terrain.rocks
        if frame.holds(rock.x_m, rock.y_m)
    )


def plan(run: RecordedRun, frame: MapFrame) -> str:
    """Both margins as bands with round joints, then the planned line."""
    bands = []
    for colour, opacity, width in (
        (palette.OFF_TRACK, 0.30, "off_track_m"),
        (palette.ON_TRACK, 0.38, "on_track_m"),
    ):
        shapes = [svg.polygon(frame.to_px(corridor(s, getattr(s, width))), fill=colour) for s in run.segments]
        shapes += [
            svg.element(
                "circle",
                cx=frame.x(s.start.x_m),
                cy=frame.y(s.start.y_m),
                r=min(getattr(s, width), getattr(before, width)) * frame.px_per_m,
                fill=colour,
            )
            for before, s in zip(run.segments, run.segments[1:], strict=False)
        ]
        bands.append(svg.element("g", *shapes, opacity=opacity))
    lines = [
        svg.line(
            *frame.to_px([(s.start.x_m, s.start.y_m)])[0],
            *frame.to_px([(s.end.x_m, s.end.y_m)])[0],
            stroke=palette.ON_TRACK,
            stroke_width=1.2,
            stroke_dasharray="7 4",
        )
        for s in run.segments
    ]
    return "".join(bands + lines)


def zones(run: RecordedRun, frame: MapFrame) -> str:
    """The tolerance zone at the end of each segment."""
    return "".join(
        svg.element(
            "circle",
            svg.title(f"tolerance zone of way-point {n}: {s.tolerance_m * 1000:.0f} mm"),
            cx=frame.x(s.end.x_m),
            cy=frame.y(s.end.y_m),
            r=s.tolerance_m * frame.px_per_m,
            fill="#ffffff",
            fill_opacity=0.55,
            stroke=palette.ON_TRACK,
            stroke_width=1.6,
        )
        for n, s in enumerate(run.segments, start=1)
    )


def true_track(track: Track, frame: MapFrame, width: float = 2.0) -> str:
    """The true track, thinned to what a pixel shows."""
    return svg.polyline(
        _distinct(frame.to_px(track.position_site_m[:, :2])),
        stroke=palette.TRUTH,
        stroke_width=width,
        stroke_linejoin="round",
    )


def believed_track(run: RecordedRun, frame: MapFrame, width: float = 1.4) -> str:
    """What the executive believed, prediction and fixes alike."""
    return svg.polyline(
        _distinct(frame.to_px([(p.x_m, p.y_m) for p in run.estimates])),
        stroke=palette.ESTIMATE,
        stroke_width=width,
        stroke_linejoin="round",
        stroke_dasharray="4 2.5",
    )


def fixes(run: RecordedRun, frame: MapFrame, sigmas: float, dot_px: float) -> str:
    """Every vision fix with its error ellipse, `sigmas` standard deviations large."""
    body = []
    for n, pose in enumerate(run.fixes, start=1):
        if not frame.holds(pose.x_m, pose.y_m):
            continue
        about = ellipse(pose.x_m, pose.y_m, pose.covariance[:2, :2], sigmas)
        said = svg.title(
            f"localisation {n} at {pose.time_s:.0f} s: x {pose.x_m:.4f} m, y {pose.y_m:.4f} m, "
            f"largest sigma {pose.sigma_position_m * 1000:.1f} mm, {pose.markers} markers"
        )
        body.append(
            svg.element(
                "g",
                said,
                svg.polygon(
                    frame.to_px(about),
                    fill=palette.FIX,
                    fill_opacity=0.16,
                    stroke=palette.FIX,
                    stroke_width=1,
                ),
                svg.element("circle", cx=frame.x(pose.x_m), cy=frame.y(pose.y_m), r=dot_px, fill=palette.FIX),
            )
        )
    return "".join(body)


def rover(
    frame: MapFrame, x_m: float, y_m: float, heading_rad: float, colour: str, opacity: float = 0.9
) -> str:
    """The rover's outline to scale, with its two tracks and its front."""
    size = RoverCalibration()
    body = frame.to_px(outline(x_m, y_m, heading_rad, size.length_m, size.width_m))
    front = [body[0], body[1]]
    return svg.element(
        "g",
        svg.polygon(body, fill="#ffffff", fill_opacity=0.35, stroke=colour, stroke_width=1.3),
        svg.polyline(front, stroke=colour, stroke_width=3.2),
        opacity=opacity,
    )


def bar_length_m(frame: MapFrame) -> float:
    """A round length, a fifth of the width or so."""
    return ticks(0.0, (frame.x1_m - frame.x0_m) / 4, 2)[-1]


def scale_bar(frame: MapFrame, x_px: float, y_px: float) -> str:
    """A bar from x on, with its length over it."""
    length = bar_length_m(frame)
    long_px = length * frame.px_per_m
    words = f"{length:g} m" if length >= 0.2 else f"{length * 1000:g} mm"
    back = svg.element(
        "rect", x=x_px - 10, y=y_px - 20, width=long_px + 20, height=32, rx=3, fill="#fff", fill_opacity=0.78
    )
    bar = svg.element("path", d=f"M{x_px} {y_px - 4}v8h{svg.number(long_px)}v-8", class_="bar")
    return back + bar + svg.text(x_px + long_px / 2, y_px - 5, words, class_="tick mid")


def graticule(frame: MapFrame) -> str:
    """Coordinates of the site along the lower and left edges [m]."""
    marks = ticks(frame.x0_m, frame.x1_m, 8)
    body = []
    for x in marks:
        body.append(
            svg.line(frame.x(x), frame.top_px, frame.x(x), frame.top_px + frame.height_px, class_="graticule")
        )
        body.append(svg.text(frame.x(x), frame.top_px + frame.height_px + 14, f"{x:g}", class_="tick mid"))
    for y in ticks(frame.y0_m, frame.y1_m, 5):
        right = frame.left_px + frame.width_px
        body.append(svg.line(frame.left_px, frame.y(y), right, frame.y(y), class_="graticule"))
        body.append(svg.text(frame.left_px - 6, frame.y(y) + 3.5, f"{y:g}", class_="tick end"))
    return "".join(body)


def exaggeration(run: RecordedRun, frame: MapFrame) -> int:
    """The round factor that makes a typical 2-sigma ellipse visible at this scale; 1 where it is anyway."""
    if not run.fixes:
        return 1
    typical_px = 2 * float(np.median([pose.sigma_position_m for pose in run.fixes])) * frame.px_per_m
    wanted = 7.0 / max(typical_px, 1e-6)
    return next((n for n in (1, 2, 5, 10, 20, 50) if n >= wanted), 100)


def _distinct(xy: list[tuple[float, float]]) -> Array:
    """The points that lie at least half a pixel from the one kept before, and the last."""
    kept = xy[:1]
    for point in xy[1:]:
        if math.dist(point, kept[-1]) >= 0.5:
            kept.append(point)
    return np.array([*kept, *xy[-1:]])
