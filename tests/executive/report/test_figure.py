"""Numbers for people: whatever a damaged or faulty run has recorded, a page can be made of it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.report.figure import duration, millimetres


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [(45.4, "45 s"), (60.0, "1 min 00 s"), (725.0, "12 min 05 s"), (11220.0, "3 h 07 min")],
)
def test_a_duration_has_its_two_largest_units(seconds, shown):
    assert duration(seconds).replace("\u00a0", " ") == shown


@given(st.floats())
def test_any_number_can_be_shown(number):
    assert duration(number) == "–" or math.isfinite(number)
    assert millimetres(number)
