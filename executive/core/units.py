"""Numbers with a unit in files, SI floats inside; the annotated types are for any pydantic model.

    class Light(BaseModel):
        sun_elevation: Angle = math.radians(35)      # the file says `35 deg`

A bare number where a dimension is meant is an error; defaults are given in SI and are not parsed.
`model_dump(mode="json")` writes them back as `"0.03 m"`, which reads back to the same float, bit for bit.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, PlainSerializer, WithJsonSchema
from pydantic_core import PydanticCustomError

from executive.core.common_units import COMMON, Dimension

if TYPE_CHECKING:
    import pint

NUMBER_TEXT = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
UNIT_TEXT = r"(?:%|°|[A-Za-zµ]{1,20}(?:\^?-?\d)?(?:[/*][A-Za-zµ]{1,20}(?:\^?-?\d)?){0,3})"
_QUANTITY = re.compile(rf"\s*({NUMBER_TEXT})\s*({UNIT_TEXT})?\s*", re.ASCII)

PLAIN: Dimension = ()


class UnitError(ValueError):
    """Text that is not a quantity, or not one of the dimension asked for."""


@dataclass(frozen=True)
class Kind:
    """A physical dimension as messages and files name it."""

    name: str
    unit: str
    example: str


LENGTH = Kind("length", "m", "30 mm")
ANGLE = Kind("angle", "rad", "0.5 deg")
DURATION = Kind("duration", "s", "36 s")
SPEED = Kind("speed", "m/s", "1.4 mm/s")
TURN_RATE = Kind("turn rate", "rad/s", "3 deg/s")
ACCELERATION = Kind("acceleration", "m/s^2", "1.62 m/s^2")
MASS = Kind("mass", "kg", "1.45 kg")
FORCE = Kind("force", "N", "2 N")
PRESSURE = Kind("pressure", "Pa", "300 Pa")
POWER = Kind("power", "W", "11 uW")
CURRENT = Kind("current", "A", "80 mA")
FRACTION = Kind("fraction", "", "40 %")

_IN_FILES = {ANGLE.unit: "deg", TURN_RATE.unit: "deg/s"}
_DEGREE = Decimal(repr(math.radians(1.0)))  # as `factor` has it, without waiting for the table of units
_DECIMALS, _FEW_TURNS = 9, 1e3

KINDS: tuple[Kind, ...] = (
    LENGTH,
    ANGLE,
    DURATION,
    SPEED,
    TURN_RATE,
    ACCELERATION,
    MASS,
    FORCE,
    PRESSURE,
    POWER,
    CURRENT,
)


@cache
def _registry() -> pint.UnitRegistry[Any]:
    """Half a second to make, so only when a file first names a unit that is not a common one."""
    import pint

    return pint.UnitRegistry()


@lru_cache(4096)
def factor(unit: str) -> tuple[Decimal, Dimension]:
    """What one `unit` is in SI, and its dimension; UnitError if there is no such unit."""
    if unit == "":
        return Decimal(1), PLAIN
    if unit == "%":
        return Decimal("0.01"), PLAIN
    return COMMON.get(unit) or looked_up(unit)


def looked_up(unit: str) -> tuple[Decimal, Dimension]:
    """What pint's table says of a unit; UnitError if there is no such unit."""
    try:
        one = _registry().Quantity(1, _registry().parse_units(unit)).to_root_units()
        if unit in {"degC", "degF", "delta_degC"}:
            raise ValueError("offset units are not proportional")
        base = one.to_base_units()
    except Exception as error:  # pint raises half a dozen unrelated types
        raise UnitError(f"unknown unit {unit!r}") from error
    exponents = {str(name): round(float(str(power))) for name, power in base.unit_items()}
    return Decimal(repr(base.magnitude)), tuple(sorted(exponents.items()))


def dimension(unit: str) -> Dimension:
    """The dimension of a unit."""
    return factor(unit)[1]


@lru_cache(4096)
def name_of(what: Dimension) -> str:
    """A dimension in words: `length`, or its root units where it has no name."""
    if what == PLAIN:
        return "plain number"
    for kind in KINDS:
        if dimension(kind.unit) == what:
            return kind.name
    return " ".join(f"{unit}^{power}" if power != 1 else unit for unit, power in what)


@lru_cache(4096)
def si_unit(what: Dimension) -> str:
    """The unit that values of this dimension carry inside: `m`, `rad`, nothing for a plain number."""
    if what == PLAIN:
        return ""
    return next((kind.unit for kind in KINDS if dimension(kind.unit) == what), name_of(what))


@lru_cache(4096)
def parse(text: str) -> tuple[float, Dimension]:
    """`"30 mm"` → (0.03, length), correctly rounded; UnitError otherwise."""
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise UnitError("not a number with a unit")
    number, unit = match.groups()
    scale, found = factor(unit or "")
    value = float(Decimal(number) * scale)
    if not math.isfinite(value):
        raise UnitError("not a finite number")
    return value, found


def split(text: str) -> tuple[float, str]:
    """`"30 mm"` → (30.0, "mm"); UnitError where the text is not a number with or without a known unit."""
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise UnitError(f"got {text!r}, expected a number with its unit")
    number, unit = match.groups()
    factor(unit or "")
    return float(Decimal(number)), unit or ""


def quantity(given: object, kind: Kind) -> float:
    """The SI value of what a file says where a `kind` is meant; UnitError says what is wrong with it."""
    if isinstance(given, bool) or not isinstance(given, str | int | float):
        raise UnitError(_message(_shown(given), kind))
    if not isinstance(given, str):
        if kind.unit == "" and math.isfinite(given):
            return float(given)
        raise UnitError(_message(f"{given!r} without a unit", kind))
    try:
        value, found = parse(given)
    except UnitError as error:
        raise UnitError(_message(f"{_shown(given)} ({error})", kind)) from None
    if found != dimension(kind.unit):
        what = "without a unit" if found == PLAIN else f"({articled(name_of(found))})"
        raise UnitError(_message(f"{_shown(given)} {what}", kind))
    return value


def _message(got: str, kind: Kind) -> str:
    return f"got {got}, expected {articled(kind.name)} such as {kind.example!r}"


def articled(noun: str) -> str:
    """`a length`, `an angle`."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def _shown(given: object) -> str:
    text = repr(given)
    return text if len(text) <= 60 else text[:57] + "..."


def written(value: float, unit: str) -> str:
    """The text that reads back to `value` bit for bit: `0.03` and `m` → `0.03 m`; angles in degrees if they
    are whole numbers of some decimals."""
    if unit in _IN_FILES and abs(value) < _FEW_TURNS:
        number = f"{math.degrees(value):.{_DECIMALS}f}".rstrip("0").rstrip(".")
        if float(Decimal(number) * _DEGREE) == value:
            return f"{number} {_IN_FILES[unit]}"
    return f"{value!r} {unit}".rstrip()


def of_kind(kind: Kind) -> Any:
    """The annotations that make a float field of a pydantic model carry `kind` in files."""

    def read(given: object) -> float:
        try:
            return quantity(given, kind)
        except UnitError as error:
            raise PydanticCustomError("quantity", "{text}", {"text": str(error)}) from None

    return (
        BeforeValidator(read),
        PlainSerializer(lambda value: written(value, kind.unit), return_type=str, when_used="json"),
        WithJsonSchema(
            {
                "type": "string",
                "format": articled(kind.name),
                "description": articled(kind.name),
                "examples": [kind.example],
            }
        ),
    )


Length = Annotated[float, *of_kind(LENGTH)]
Angle = Annotated[float, *of_kind(ANGLE)]
Duration = Annotated[float, *of_kind(DURATION)]
Speed = Annotated[float, *of_kind(SPEED)]
TurnRate = Annotated[float, *of_kind(TURN_RATE)]
Acceleration = Annotated[float, *of_kind(ACCELERATION)]
Mass = Annotated[float, *of_kind(MASS)]
Force = Annotated[float, *of_kind(FORCE)]
Pressure = Annotated[float, *of_kind(PRESSURE)]
Power = Annotated[float, *of_kind(POWER)]
Current = Annotated[float, *of_kind(CURRENT)]
Fraction = Annotated[float, *of_kind(FRACTION)]
