"""The types that ports carry: a name, a Python type, a dimension where it has one, and its attributes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from operator import attrgetter
from typing import Any, Generic, TypeVar

from executive.core.registry import Kind
from executive.core.types import (
    Point,
    PoseEstimate,
    Quality,
    Segment,
)

T_co = TypeVar("T_co", covariant=True)


@dataclass(frozen=True)
class ValueAttribute:
    """What may be asked of a value: its type, and how to read it (None: the value has none at present)."""

    type: ValueType[Any]
    read: Callable[[Any], Any]


@dataclass(frozen=True)
class ValueType(Generic[T_co]):
    """A port type. `unit` is the SI unit of a dimensioned number (files must then carry a unit).

    `literal` says whether a file may give it as a literal; the rest flows between nodes only. `attributes`
    are what a tree file may ask of a value: `{pose.cross_track}`.
    """

    name: str
    python: type[T_co]
    unit: str | None = None
    literal: bool = True
    attributes: Mapping[str, ValueAttribute] = field(default_factory=dict, compare=False)


def attribute_of(kind: ValueType[Any], names: tuple[str, ...]) -> ValueType[Any]:
    """The type behind a chain of attributes; LookupError(name, owner, known) where one does not exist."""
    for name in names:
        if name not in kind.attributes:
            raise LookupError(name, kind.name, tuple(kind.attributes))
        kind = kind.attributes[name].type
    return kind


def read_attribute(kind: ValueType[Any], value: Any, names: tuple[str, ...]) -> Any:
    """Follow a chain of attributes; None as soon as something on the way is unset."""
    for name in names:
        if value is None:
            return None
        attribute = kind.attributes[name]
        kind, value = attribute.type, attribute.read(value)
    return value


LENGTH = ValueType("length", float, "m")
ANGLE = ValueType("angle", float, "rad")
DURATION = ValueType("duration", float, "s")
SPEED = ValueType("speed", float, "m/s")
FORCE = ValueType("force", float, "N")
CURRENT = ValueType("current", float, "A")
NUMBER = ValueType("number", float)
INTEGER = ValueType("integer", int)
FLAG = ValueType("flag", bool)
TEXT = ValueType("text", str)
QUALITY = ValueType("Quality", Quality)


def _of(kind: ValueType[Any], field_name: str) -> ValueAttribute:
    return ValueAttribute(kind, attrgetter(field_name))


def _track(field_name: str) -> ValueAttribute:
    return ValueAttribute(
        LENGTH, lambda pose: None if pose.track is None else getattr(pose.track, field_name)
    )


POINT = ValueType(
    "Point", Point, literal=False, attributes={"x": _of(LENGTH, "x_m"), "y": _of(LENGTH, "y_m")}
)
POSE = ValueType(
    "PoseEstimate",
    PoseEstimate,
    literal=False,
    attributes={
        "x": _of(LENGTH, "x_m"),
        "y": _of(LENGTH, "y_m"),
        "z": ValueAttribute(LENGTH, lambda pose: pose.position_site_m[2]),
        "point": _of(POINT, "point"),
        "heading": _of(ANGLE, "heading_rad"),
        "tilt": _of(ANGLE, "tilt_rad"),
        "sigma_position": _of(LENGTH, "sigma_position_m"),
        "sigma_heading": _of(ANGLE, "sigma_heading_rad"),
        "cross_track": _track("cross_m"),
        "along_track": _track("along_m"),
        "remaining": _track("remaining_m"),
    },
)
SEGMENT = ValueType(
    "Segment",
    Segment,
    literal=False,
    attributes={
        "start": _of(POINT, "start"),
        "end": _of(POINT, "end"),
        "off_track": _of(LENGTH, "off_track_m"),
        "on_track": _of(LENGTH, "on_track_m"),
        "tolerance": _of(LENGTH, "tolerance_m"),
        "length": _of(LENGTH, "length_m"),
        "bearing": _of(ANGLE, "bearing_rad"),
        "index": _of(INTEGER, "index"),
    },
)
ROUTE: ValueType[tuple[Segment, ...]] = ValueType("Route", tuple, literal=False)


def _broken(kind: ValueType[object]) -> Iterator[str]:
    plain = (float, int, bool, str)
    if kind.literal and not (kind.python in plain or issubclass(kind.python, Enum)):
        yield f"a {kind.python.__name__} has no literals: literal=False is missing"
    if kind.unit is not None and kind.python is not float:
        yield f"a {kind.python.__name__} has no unit, only a float has"
    for name, attribute in kind.attributes.items():
        if not name.isidentifier():
            yield f"got the attribute {name!r}, expected an identifier"
        if not isinstance(attribute, ValueAttribute):
            yield f"its attribute {name} is {attribute!r}, expected a ValueAttribute"


def _page(kind: ValueType[object]) -> Mapping[str, Any]:
    """What the catalogue says of a type: what it is in Python, its unit, and what may be asked of it."""
    return {
        "python": kind.python.__name__,
        "unit": kind.unit,
        "literal": kind.literal,
        "attributes": [{"name": name, "type": a.type.name} for name, a in kind.attributes.items()],
    }


VALUE_TYPE_KIND: Kind[ValueType[object]] = Kind(
    "value type",
    "value_types",
    "What a port of a node or of a tree carries.",
    ValueType,
    check=_broken,
    page=_page,
)
