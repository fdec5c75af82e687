"""The signals that every robot has, and those of a simulator's truth. A device's are made from its spec."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from executive.core.devices import INCLINOMETER
from executive.core.types import PoseEstimate
from executive.core.values import ANGLE, FORCE, INTEGER, LENGTH, NUMBER, ValueType
from executive.record.events import DeviceReading, Telemetry, TruthEvent, WaypointEvent
from executive.record.signal import Signal


def tilt_rad(roll_rad: float, pitch_rad: float) -> float:
    """Angle between the body's z axis and the vertical."""
    return math.acos(max(-1.0, min(1.0, math.cos(roll_rad) * math.cos(pitch_rad))))


def _tilt(event: Telemetry | DeviceReading) -> float | None:
    if isinstance(event, Telemetry):
        return tilt_rad(event.roll_rad, event.pitch_rad)
    if event.device != INCLINOMETER.name:
        return None
    return tilt_rad(event.values["roll"], event.values["pitch"])


def _true_tilt(event: TruthEvent) -> float:
    x, y, _, _ = event.quat_site_body
    return math.acos(max(-1.0, min(1.0, 1 - 2 * (x * x + y * y))))


def _pose(name: str, kind: ValueType[Any], read: Callable[[PoseEstimate], float | None], doc: str) -> Signal:
    return Signal(name, kind, (PoseEstimate,), read, doc)


def _truth(name: str, kind: ValueType[Any], read: Callable[[TruthEvent], float], doc: str) -> Signal:
    return Signal(name, kind, (TruthEvent,), read, doc, truth=True)


def _along(part: str) -> Callable[[PoseEstimate], float | None]:
    return lambda e: getattr(e.track, part) if e.track else None


TILT = Signal("tilt", ANGLE, (Telemetry, DeviceReading), _tilt, "by the inclinometers")
X = _pose("x", LENGTH, lambda e: e.x_m, "believed position in site")
Y = _pose("y", LENGTH, lambda e: e.y_m, "believed position in site")
HEADING = _pose("heading", ANGLE, lambda e: e.heading_rad, "believed heading from site x")
SIGMA_POSITION = _pose("sigma_position", LENGTH, lambda e: e.sigma_position_m, "of the believed position")
SIGMA_HEADING = _pose("sigma_heading", ANGLE, lambda e: e.sigma_heading_rad, "of the believed heading")
CROSS_TRACK = _pose("cross_track", LENGTH, _along("cross_m"), "left of the segment")
ALONG_TRACK = _pose("along_track", LENGTH, _along("along_m"), "along the segment")
REMAINING = _pose("remaining", LENGTH, _along("remaining_m"), "to the way-point")
MARKERS = _pose("markers", INTEGER, lambda e: e.markers or None, "seen in the last fix")
WAYPOINT = Signal("waypoint", INTEGER, (WaypointEvent,), lambda e: e.index, "the last one declared reached")
TRUE_X = _truth("true_x", LENGTH, lambda e: e.position_site_m[0], "true position in site")
TRUE_Y = _truth("true_y", LENGTH, lambda e: e.position_site_m[1], "true position in site")
TRUE_TILT = _truth("true_tilt", ANGLE, _true_tilt, "true tilt")
TRUE_TETHER_TENSION = _truth("true_tether_tension", FORCE, lambda e: e.tether_n, "true pull of the tether")
SLIP_LEFT = _truth("slip_left", NUMBER, lambda e: e.slip_left, "true slip of the left track")
SLIP_RIGHT = _truth("slip_right", NUMBER, lambda e: e.slip_right, "true slip of the right track")
