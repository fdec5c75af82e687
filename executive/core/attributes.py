"""What may be asked of a value in a tree file: `{pose.cross_track}`, `{segment.end}`. The one table of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from executive.core.values import (
    ANGLE,
    INTEGER,
    LENGTH,
    POINT,
    POSE,
    SEGMENT,
    ValueType,
)


@dataclass(frozen=True)
class Attribute:
    """The type of an attribute, and how to read it: None where the value has none at present."""

    type: ValueType[Any]
    read: Callable[[Any], Any]


def _track(name: str) -> Callable[[Any], Any]:
    return lambda pose: None if pose.track is None else getattr(pose.track, name)


ATTRIBUTES: dict[str, dict[str, Attribute]] = {
    POINT.name: {
        "x": Attribute(LENGTH, lambda point: point.x_m),
        "y": Attribute(LENGTH, lambda point: point.y_m),
    },
    POSE.name: {
        "x": Attribute(LENGTH, lambda pose: pose.x_m),
        "y": Attribute(LENGTH, lambda pose: pose.y_m),
        "z": Attribute(LENGTH, lambda pose: pose.position_site_m[2]),
        "point": Attribute(POINT, lambda pose: pose.point),
        "heading": Attribute(ANGLE, lambda pose: pose.heading_rad),
        "tilt": Attribute(ANGLE, lambda pose: pose.tilt_rad),
        "sigma_position": Attribute(LENGTH, lambda pose: pose.sigma_position_m),
        "sigma_heading": Attribute(ANGLE, lambda pose: pose.sigma_heading_rad),
        "cross_track": Attribute(LENGTH, _track("cross_m")),
        "along_track": Attribute(LENGTH, _track("along_m")),
        "remaining": Attribute(LENGTH, _track("remaining_m")),
    },
    SEGMENT.name: {
        "start": Attribute(POINT, lambda segment: segment.start),
        "end": Attribute(POINT, lambda segment: segment.end),
        "off_track": Attribute(LENGTH, lambda segment: segment.off_track_m),
        "on_track": Attribute(LENGTH, lambda segment: segment.on_track_m),
        "tolerance": Attribute(LENGTH, lambda segment: segment.tolerance_m),
        "length": Attribute(LENGTH, lambda segment: segment.length_m),
        "bearing": Attribute(ANGLE, lambda segment: segment.bearing_rad),
        "index": Attribute(INTEGER, lambda segment: segment.index),
    },
}


def attribute_of(kind: ValueType[Any], names: tuple[str, ...]) -> ValueType[Any]:
    """The type behind a chain of attributes; LookupError(name, known) where one does not exist."""
    for name in names:
        known = ATTRIBUTES.get(kind.name, {})
        if name not in known:
            raise LookupError(name, kind.name, tuple(known))
        kind = known[name].type
    return kind


def read_attribute(kind: ValueType[Any], value: Any, names: tuple[str, ...]) -> Any:
    """Follow a chain of attributes; None as soon as something on the way is unset."""
    for name in names:
        if value is None:
            return None
        attribute = ATTRIBUTES[kind.name][name]
        kind, value = attribute.type, attribute.read(value)
    return value
