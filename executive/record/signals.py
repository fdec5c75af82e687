"""Named signals: numbers over mission time that triggers and expectations speak of, from the record's events.

The same table serves a run under way (each event as it is written) and a record read afterwards.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from executive.core.types import PoseEstimate
from executive.core.values import (
    ANGLE,
    CURRENT,
    FLAG,
    FORCE,
    INTEGER,
    LENGTH,
    NUMBER,
    ValueType,
)
from executive.isc import hypothesis_names
from executive.record.events import (
    HypothesesEvent,
    Telemetry,
    TruthEvent,
    WaypointEvent,
)


@dataclass(frozen=True)
class Signal:
    """One number of one type of event; `read` gives None where an event does not have it.

    `truth` signals are in the simulator's record only: expectations may speak of them, triggers not.
    """

    kind: ValueType[Any]
    event: type[object]
    read: Callable[[Any], float | bool | None]
    doc: str
    truth: bool = False


def tilt_rad(roll_rad: float, pitch_rad: float) -> float:
    """Angle between the body's z axis and the vertical."""
    return math.acos(max(-1.0, min(1.0, math.cos(roll_rad) * math.cos(pitch_rad))))


def _field(name: str, kind: ValueType[Any], doc: str) -> Signal:
    return Signal(kind, Telemetry, lambda event: getattr(event, name), doc)


def _pose(kind: ValueType[Any], read: Callable[[PoseEstimate], float | None], doc: str) -> Signal:
    return Signal(kind, PoseEstimate, read, doc)


def _weight(hypothesis: str) -> Signal:
    return Signal(NUMBER, HypothesesEvent, lambda event: event.weights.get(hypothesis), "weight of it")


def _true_tilt(event: TruthEvent) -> float:
    x, y, _, _ = event.quat_site_body
    return math.acos(max(-1.0, min(1.0, 1 - 2 * (x * x + y * y))))


def _truth(kind: ValueType[Any], read: Callable[[TruthEvent], float], doc: str) -> Signal:
    return Signal(kind, TruthEvent, read, doc, truth=True)


_READ: Mapping[str, Signal] = {
    "tilt": Signal(ANGLE, Telemetry, lambda e: tilt_rad(e.roll_rad, e.pitch_rad), "by the inclinometers"),
    "roll": _field("roll_rad", ANGLE, "about the body's x axis"),
    "pitch": _field("pitch_rad", ANGLE, "about the body's y axis"),
    "left": _field("left_m", LENGTH, "travel of the left belt"),
    "right": _field("right_m", LENGTH, "travel of the right belt"),
    "left_current": _field("left_current_a", CURRENT, "of the left motor"),
    "right_current": _field("right_current_a", CURRENT, "of the right motor"),
    "arm": _field("arm_rad", ANGLE, "angle of the arm joint"),
    "cabin": _field("cabin_rad", ANGLE, "angle of the cabin joint"),
    "pan": _field("pan_rad", ANGLE, "of the head, by its encoder"),
    "head_tilt": _field("tilt_rad", ANGLE, "of the head, by its encoder"),
    "tether_length": _field("tether_m", LENGTH, "paid out"),
    "tether_tension": _field("tether_n", FORCE, "at the spool"),
    "moving": _field("moving", FLAG, "whether a drive is under way"),
    "x": _pose(LENGTH, lambda e: e.x_m, "believed position in site"),
    "y": _pose(LENGTH, lambda e: e.y_m, "believed position in site"),
    "heading": _pose(ANGLE, lambda e: e.heading_rad, "believed heading from site x"),
    "sigma_position": _pose(LENGTH, lambda e: e.sigma_position_m, "of the believed position"),
    "sigma_heading": _pose(ANGLE, lambda e: e.sigma_heading_rad, "of the believed heading"),
    "cross_track": _pose(LENGTH, lambda e: e.track.cross_m if e.track else None, "left of the segment"),
    "along_track": _pose(LENGTH, lambda e: e.track.along_m if e.track else None, "along the segment"),
    "remaining": _pose(LENGTH, lambda e: e.track.remaining_m if e.track else None, "to the way-point"),
    "markers": _pose(INTEGER, lambda e: e.markers or None, "seen in the last fix"),
    "waypoint": Signal(INTEGER, WaypointEvent, lambda e: e.index, "the last one declared reached"),
}
_TRUE: Mapping[str, Signal] = {
    "true_x": _truth(LENGTH, lambda e: e.position_site_m[0], "true position in site"),
    "true_y": _truth(LENGTH, lambda e: e.position_site_m[1], "true position in site"),
    "true_tilt": _truth(ANGLE, _true_tilt, "true tilt"),
    "true_tether_tension": _truth(FORCE, lambda e: e.tether_n, "true pull of the tether"),
    "slip_left": _truth(NUMBER, lambda e: e.slip_left, "true slip of the left track"),
    "slip_right": _truth(NUMBER, lambda e: e.slip_right, "true slip of the right track"),
}


def signals() -> Mapping[str, Signal]:
    """All there are by name: of the robot, the weight of each registered hypothesis, and of the truth."""
    return _signals(hypothesis_names())


def types() -> Mapping[str, ValueType[Any]]:
    """What an expectation may speak of."""
    return {name: signal.kind for name, signal in signals().items()}


def live_types() -> Mapping[str, ValueType[Any]]:
    """What a trigger may speak of, while the run is under way."""
    return {name: signal.kind for name, signal in signals().items() if not signal.truth}


@cache
def _signals(hypotheses: tuple[str, ...]) -> Mapping[str, Signal]:
    return {**_READ, **{name: _weight(name) for name in hypotheses}, **_TRUE}


_OF_EVENT: dict[type, list[tuple[str, Signal]]] = {}
for _name, _signal in {**_READ, **_TRUE}.items():
    _OF_EVENT.setdefault(_signal.event, []).append((_name, _signal))


def heard(event: object) -> Iterator[tuple[str, float]]:
    """The signals that an event gives a value."""
    if isinstance(event, HypothesesEvent):
        yield from event.weights.items()
    for name, signal in _OF_EVENT.get(type(event), ()):
        if (value := signal.read(event)) is not None:
            yield name, value
