"""What was injected, on the map: what lies in the world by it, where the rover was when it took effect."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from executive.core.types import Vec2
from executive.record.events import Placed, PlacedEvent
from executive.report import palette, svg
from executive.report.figure import duration
from executive.report.frame import MapFrame
from executive.report.gather import RecordedRun

_SIZE_PX, _LEAST_PX = 8.0, 4.0
_WORDS = {
    "rock": "a rock",
    "rise": "a rise of the ground",
    "soil": "other soil",
    "snag": "the tether is caught",
}


class Stay(NamedTuple):
    """What one fault had lying in the world, where it came to lie, since when, and until when [s]."""

    fault: str
    things: tuple[Placed, ...]
    since_s: float
    until_s: float | None


def stays(run: RecordedRun) -> list[Stay]:
    """Every stay in the world, in order; of what moved, the last place."""
    found: list[Stay] = []
    under_way: dict[str, Stay] = {}
    for time_s, event in run.history.all(PlacedEvent):
        before = under_way.pop(event.name, None)
        if event.things:
            since_s = before.since_s if before is not None else time_s
            under_way[event.name] = Stay(event.name, event.things, since_s, None)
        elif before is not None:
            found.append(before._replace(until_s=time_s))
    return sorted([*found, *under_way.values()], key=lambda stay: stay.since_s)


def numbers(run: RecordedRun) -> Mapping[str, str]:
    """How map and table call each fault: 1, 2, …, in the order of the table."""
    return {row.name: str(n) for n, row in enumerate(run.result.faults, start=1)}


def places(run: RecordedRun) -> list[Vec2]:
    """Where something was put, for the map to hold it."""
    return [(thing.x_m, thing.y_m) for stay in stays(run) for thing in stay.things]


def things(run: RecordedRun, frame: MapFrame) -> str:
    """What was put into the world: circles in the colour of faults, dashed once it is gone again."""
    return "".join(_thing(stay, thing, frame) for stay in stays(run) for thing in stay.things)


def _thing(stay: Stay, thing: Placed, frame: MapFrame) -> str:
    what = _WORDS.get(thing.kind, thing.kind)
    until = "" if stay.until_s is None else f" to {duration(stay.until_s)}"
    words = (
        f"{stay.fault}: {what}, radius {thing.radius_m * 1000:.0f} mm, from {duration(stay.since_s)}{until}"
    )
    solid = thing.kind == "rock" and stay.until_s is None
    return svg.element(
        "circle",
        svg.title(words),
        cx=frame.x(thing.x_m),
        cy=frame.y(thing.y_m),
        r=max(thing.radius_m * frame.px_per_m, _LEAST_PX),
        fill=palette.FAULT,
        fill_opacity=0.55 if solid else 0.16,
        stroke=palette.FAULT,
        stroke_width=1.6,
        stroke_dasharray=None if solid else "4 3",
        class_="injected",
    )


def onsets(run: RecordedRun, frame: MapFrame) -> str:
    """A numbered triangle over where the rover was when a fault took effect; of one place, side by side."""
    return "".join(_onset(*mark) for mark in _marks(run, frame))


def _marks(run: RecordedRun, frame: MapFrame) -> Iterator[tuple[float, float, str, str]]:
    taken: dict[tuple[int, int], int] = {}
    for name, number in numbers(run).items():
        row = next(row for row in run.result.faults if row.name == name)
        at = None if row.t_on_s is None else where(run, row.t_on_s)
        if at is None or row.t_on_s is None:
            continue
        cell = (round(frame.x(at[0]) / 30), round(frame.y(at[1]) / 30))
        beside = taken[cell] = taken.get(cell, -1) + 1
        words = f"{name} took effect at {duration(row.t_on_s)}, the rover being here"
        yield frame.x(at[0]) + 2.4 * _SIZE_PX * beside, frame.y(at[1]), number, words


def _onset(x: float, y: float, number: str, words: str) -> str:
    top = y - 3.2 * _SIZE_PX
    corners = [(x, top + 2 * _SIZE_PX), (x - 1.2 * _SIZE_PX, top), (x + 1.2 * _SIZE_PX, top)]
    return svg.element(
        "g",
        svg.title(words),
        svg.line(x, y, x, top, stroke=palette.FAULT, stroke_width=1.2),
        svg.polygon(corners, fill=palette.FAULT),
        svg.text(x, top + 9, number, class_="letter"),
        class_="onset",
    )


def where(run: RecordedRun, time_s: float) -> Vec2 | None:
    """Where the rover was then: truly, else as it believed."""
    track = run.track
    if track is not None and len(track.time_s):
        index = min(int(np.searchsorted(track.time_s, time_s)), len(track.time_s) - 1)
        x_m, y_m = (float(v) for v in track.position_site_m[index, :2])
        return x_m, y_m
    pose = run.believed_at(time_s)
    return None if pose is None else (pose.x_m, pose.y_m)
