"""The types that ports carry: a name, a Python type, and a dimension where it has one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Generic, TypeVar

from executive.core.registry import Kind
from executive.core.types import (
    Point,
    PoseEstimate,
    Quality,
    Segment,
)

T_co = TypeVar("T_co", covariant=True)


@dataclass(frozen=True)
class ValueType(Generic[T_co]):
    """A port type. `unit` is the SI unit of a dimensioned number (files must then carry a unit).

    `literal` says whether a file may give it as a literal; the rest flows between nodes only.
    """

    name: str
    python: type[T_co]
    unit: str | None = None
    literal: bool = True


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
POINT = ValueType("Point", Point, literal=False)
POSE = ValueType("PoseEstimate", PoseEstimate, literal=False)
SEGMENT = ValueType("Segment", Segment, literal=False)
ROUTE: ValueType[tuple[Segment, ...]] = ValueType("Route", tuple, literal=False)


def _broken(kind: ValueType[object]) -> Iterator[str]:
    plain = (float, int, bool, str)
    if kind.literal and not (kind.python in plain or issubclass(kind.python, Enum)):
        yield f"a {kind.python.__name__} has no literals: literal=False is missing"
    if kind.unit is not None and kind.python is not float:
        yield f"a {kind.python.__name__} has no unit, only a float has"


VALUE_TYPE_KIND: Kind[ValueType[object]] = Kind(
    "value type", "value_types", "What a port of a node or of a tree carries.", ValueType, check=_broken
)
