import math
from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, Field, ValidationError

from executive.core import units
from executive.core.common_units import COMMON
from executive.core.units import UnitError


@pytest.mark.parametrize("unit", COMMON)
def test_a_common_unit_is_what_the_table_of_all_units_says(unit):
    assert units.factor(unit) == COMMON[unit] == units.looked_up(unit)


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("30 mm", units.LENGTH, 0.03),
        ("9mm", units.LENGTH, 0.009),
        ("-0.4 m", units.LENGTH, -0.4),
        ("0.5 deg", units.ANGLE, math.radians(0.5)),
        ("0.94 arcmin", units.ANGLE, math.radians(0.94 / 60)),
        ("5 mrad", units.ANGLE, 0.005),
        ("20 min", units.DURATION, 1200.0),
        ("1.4 mm/s", units.SPEED, 0.0014),
        ("40 %", units.FRACTION, 0.4),
        ("1.45 kg", units.MASS, 1.45),
        ("3 deg/s", units.TURN_RATE, math.radians(3)),
    ],
)
def test_a_number_with_a_unit_becomes_si(text, kind, value):
    assert units.quantity(text, kind) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("given_", "message"),
    [
        (30, "got 30 without a unit, expected a length such as '30 mm'"),
        ("30", "got '30' without a unit, expected a length such as '30 mm'"),
        ("30 deg", "got '30 deg' (an angle), expected a length such as '30 mm'"),
        ("30 foo", "got '30 foo' (unknown unit 'foo'), expected a length such as '30 mm'"),
        ("1e999 m", "got '1e999 m' (not a finite number), expected a length such as '30 mm'"),
        ("nan m", "got 'nan m' (not a number with a unit), expected a length such as '30 mm'"),
        (True, "got True, expected a length such as '30 mm'"),
        (None, "got None, expected a length such as '30 mm'"),
    ],
)
def test_anything_else_is_refused_with_what_was_expected(given_, message):
    with pytest.raises(UnitError) as caught:
        units.quantity(given_, units.LENGTH)
    assert str(caught.value) == message


@given(
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([units.LENGTH, units.ANGLE, units.SPEED]),
)
def test_what_is_written_reads_back_bit_for_bit(value, kind):
    again = units.quantity(units.written(value, kind.unit), kind)
    assert again == value
    assert math.copysign(1, again) == math.copysign(1, value) or value == 0


@given(st.text(max_size=30))
def test_any_text_is_a_quantity_or_a_unit_error(text):
    try:
        value, _ = units.parse(text)
    except UnitError:
        return
    assert math.isfinite(value)


class World(BaseModel):
    height: units.Length = 1.5
    speed: Annotated[units.Speed, Field(gt=0)] = 0.0014
    corner: tuple[units.Length, units.Length] = (0.0, 0.0)


def test_a_model_reads_units_and_writes_si():
    world = World.model_validate({"height": "30 mm", "corner": ("1 m", "2 cm")})
    assert (world.height, world.corner, world.speed) == (0.03, (1.0, 0.02), 0.0014)
    assert world.model_dump(mode="json") == {
        "height": "0.03 m",
        "speed": "0.0014 m/s",
        "corner": ["1.0 m", "0.02 m"],
    }


def test_constraints_apply_to_the_si_value():
    with pytest.raises(ValidationError, match="greater than 0"):
        World.model_validate({"speed": "-1 mm/s"})


def test_dimensions_have_names():
    assert units.name_of(units.dimension("km/h")) == "speed"
    assert units.name_of(units.dimension("m*m")) == "meter^2"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (math.radians(35.0), "rad", "35 deg"),
        (math.radians(-0.4), "rad", "-0.4 deg"),
        (math.radians(10.0), "rad/s", "10 deg/s"),
        (0.005, "rad", "0.005 rad"),
        (0.03, "m", "0.03 m"),
    ],
)
def test_angles_are_written_in_degrees_where_these_read_back(value, unit, text):
    assert units.written(value, unit) == text
    assert units.parse(text)[0] == value
