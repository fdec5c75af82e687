"""The map of the whole run."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import PoseEstimate
from executive.record.events import StrategyEvent, Verdict
from executive.report import injected, layers, palette, svg
from executive.report.axes import legend
from executive.report.figure import Figure
from executive.report.frame import MapFrame, corridor
from executive.report.gather import RecordedRun

_WIDTH, _LEFT, _BOTTOM = 1100.0, 44.0, 24.0
_STEREO_HALF_ANGLE_RAD = math.radians(11.5)


def overview(run: RecordedRun) -> Figure | None:
    """Plan, tracks, localisations and strategies over the terrain; None where there is nothing to place."""
    xy = [p for s in run.segments for p in corridor(s, s.off_track_m)] + [
        (p.x_m, p.y_m) for p in run.estimates
    ]
    xy += injected.places(run)
    if not xy:
        return None
    frame = MapFrame.around(np.array([*xy, (0.0, 0.0)]), _WIDTH - _LEFT, 0.22, (300.0, 660.0))
    frame = MapFrame(frame.x0_m, frame.y0_m, frame.x1_m, frame.y1_m, frame.px_per_m, _LEFT, 4.0)
    factor = layers.exaggeration(run, frame)
    bar_x = _LEFT + frame.width_px - layers.bar_length_m(frame) * frame.px_per_m - 26
    clip = svg.element(
        "clipPath",
        svg.element("rect", x=_LEFT, y=4, width=frame.width_px, height=frame.height_px),
        id="map-clip",
    )
    inside = [
        layers.ground(run, frame),
        _views(run, frame),
        layers.plan(run, frame),
        injected.things(run, frame),
        layers.zones(run, frame),
        _rovers(run, frame),
        layers.believed_track(run, frame),
        layers.true_track(run.track, frame) if run.track else "",
        layers.fixes(run, frame, 2.0 * factor, 1.8),
        _waypoints(run, frame),
        _strategies(run, frame),
        injected.onsets(run, frame),
        _lander(frame),
        layers.scale_bar(frame, bar_x, frame.height_px - 16),
    ]
    body = [
        svg.element("defs", clip),
        svg.element("g", *inside, clip_path="url(#map-clip)"),
        layers.graticule(frame),
        svg.element("circle", r=5, class_="here", visibility="hidden", id="here"),
    ]
    drawn = svg.drawing(
        _WIDTH,
        frame.height_px + _BOTTOM + 4,
        body,
        id="site-map",
        data_px=frame.px_per_m,
        data_x0=frame.x(0),
        data_y0=frame.y(0),
        aria_label="Map of the run",
    )
    return Figure("map", "Map", legend(_legend(run, factor)) + drawn, _caption(run, factor))


def _legend(run: RecordedRun, factor: int) -> list[tuple[str, str, str]]:
    scaled = f", drawn ×{factor}" if factor > 1 else ""
    entries = [
        ("area", palette.ON_TRACK, "on-track margin"),
        ("area", palette.OFF_TRACK, "off-track margin"),
        ("ring", palette.ON_TRACK, "tolerance zone"),
        ("dash", palette.ESTIMATE, "believed track"),
        ("ring", palette.FIX, f"localisation, 2σ{scaled}"),
        ("mark", palette.STRATEGY, "strategy"),
    ]
    if run.result.faults:
        entries.append(("warn", palette.FAULT, "injected fault"))
    if injected.stays(run):
        entries.append(("ring", palette.FAULT, "put into the world by a fault"))
    if run.track is not None:
        entries.insert(3, ("line", palette.TRUTH, "true track"))
    return entries


def _caption(run: RecordedRun, factor: int) -> str:
    scaled = (
        f" The ellipses are drawn {factor} times too large to be seen at this scale; "
        "in the way-point views below they are true."
        if factor > 1
        else ""
    )
    truth = (
        "The black line is where the rover really was, which the executive never saw; "
        if run.track is not None
        else "No truth was recorded; "
    )
    return (
        "The site from above, x to the right and y up, in metres from the foot of the mast. "
        f"{truth}the dashed blue line is what it believed between localisations.{scaled} "
        "Grey rays lead from the head to each place where it looked. Numbers are way-points, "
        "diamonds with letters the strategies and triangles with numbers the injected faults of the tables "
        "below, each where the rover was then. The rover is drawn to scale at its start "
        "and its end."
    )


def _views(run: RecordedRun, frame: MapFrame) -> str:
    rays = [svg.line(frame.x(0), frame.y(0), frame.x(p.x_m), frame.y(p.y_m), class_="ray") for p in run.fixes]
    if run.fixes:
        rays.insert(0, _wedge(run.fixes[-1], frame))
    return "".join(rays)


def _wedge(pose: PoseEstimate, frame: MapFrame) -> str:
    """The field of view at the last localisation."""
    bearing, reach = math.atan2(pose.y_m, pose.x_m), math.hypot(pose.x_m, pose.y_m) + 0.4
    corners = [(0.0, 0.0)]
    for side in (-_STEREO_HALF_ANGLE_RAD, _STEREO_HALF_ANGLE_RAD):
        corners.append((reach * math.cos(bearing + side), reach * math.sin(bearing + side)))
    return svg.polygon(frame.to_px(corners), fill="#ffffff", fill_opacity=0.2)


def _rovers(run: RecordedRun, frame: MapFrame) -> str:
    poses = [run.fixes[0], run.fixes[-1]] if run.fixes else []
    drawn = [
        layers.rover(frame, p.x_m, p.y_m, p.heading_rad, palette.INK, opacity)
        for p, opacity in zip(poses, (0.45, 0.9), strict=False)
    ]
    return "".join(drawn)


def _waypoints(run: RecordedRun, frame: MapFrame) -> str:
    if not run.segments:
        return ""
    places = [run.segments[0].start, *(s.end for s in run.segments)]
    body = []
    for n, place in enumerate(places):
        x, y = frame.x(place.x_m), frame.y(place.y_m)
        body.append(svg.element("path", d=f"M{x - 5:.1f} {y:.1f}h10M{x:.1f} {y - 5:.1f}v10", class_="cross"))
        body.append(svg.text(x + 9, y - 9, str(n) if n else "start", class_="waypoint"))
    return "".join(body)


def _strategies(run: RecordedRun, frame: MapFrame) -> str:
    body = []
    chosen = [at for at in run.history.all(StrategyEvent) if at.event.verdict is Verdict.CHOSEN]
    for n, (time_s, event) in enumerate(chosen):
        pose = run.believed_at(time_s)
        if pose is None:
            continue
        x, y = frame.x(pose.x_m), frame.y(pose.y_m) + 24
        diamond = [(x, y - 10), (x + 10, y), (x, y + 10), (x - 10, y)]
        body.append(
            svg.element(
                "g",
                svg.title(f"{event.name} at {time_s:.0f} s against {event.hypothesis}"),
                svg.line(x, y - 24, x, y - 10, stroke=palette.STRATEGY, stroke_width=1.2),
                svg.polygon(diamond, fill=palette.STRATEGY),
                svg.text(x, y + 3.6, letter(n), class_="letter"),
            )
        )
    return "".join(body)


def letter(n: int) -> str:
    """A, B, … Z, A1, B1, …: the name of the n-th strategy in map and table."""
    return chr(ord("A") + n % 26) + (str(n // 26) if n >= 26 else "")


def _lander(frame: MapFrame) -> str:
    x, y = frame.x(0), frame.y(0)
    arrows = [
        svg.element("path", d=f"M{x:.1f} {y:.1f}h34m-6 -3l6 3l-6 3", class_="arrow"),
        svg.element("path", d=f"M{x:.1f} {y:.1f}v-34m-3 6l3 -6l3 6", class_="arrow"),
        svg.text(x + 38, y + 4, "x", class_="tick"),
        svg.text(x - 3, y - 38, "y", class_="tick"),
    ]
    hexagon = [
        (x + 12 * math.cos(a), y + 12 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 7)[:6] + 0.5236
    ]
    mast = svg.polygon(hexagon, fill="#fff", stroke=palette.INK, stroke_width=1.5)
    head = svg.element("circle", cx=x, cy=y, r=3.2, fill=palette.INK)
    return "".join([*arrows, mast, head, svg.text(x - 16, y + 28, "lander, mast", class_="tick")])
