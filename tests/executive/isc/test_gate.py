"""A fix cannot lie farther than the belts carried the rover."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core.types import PoseEstimate
from executive.isc.attitude import quat_from_heading_tilt
from executive.isc.gate import Reach


def at(x=3.0, y=0.0, heading_deg=0.0, sigma=0.001):
    quat = quat_from_heading_tilt(math.radians(heading_deg), 0.0, 0.0)
    return PoseEstimate(0.0, (x, y, 0.0), quat, np.eye(6) * sigma**2, "markers")


@pytest.mark.parametrize(
    ("fix", "complaint"),
    [
        (at(3.09), None),
        (at(3.01, 0.02, 6.0), None),
        (at(3.3), "moved 300 mm on 100 mm of belt travel"),
        (at(3.0, -0.2), "moved 200 mm on 100 mm of belt travel"),
        (at(3.05, heading_deg=40), "turned 40 deg where the belts allow 12 deg"),
        (at(3.2, sigma=0.05), None),
    ],
)
def test_a_fix_is_held_against_the_belt_travel_since_the_last(fix, complaint):
    reach = Reach(at())
    for _ in range(10):
        reach = reach.driven(0.01, 0.01, 0.115)
    assert reach.beyond(fix) == complaint


def test_turning_on_the_spot_turns_but_does_not_carry():
    reach = Reach(at()).driven(-0.1, 0.1, 0.115)
    assert reach.beyond(at(heading_deg=60)) is None
    assert reach.beyond(at(3.3, heading_deg=60)) is not None


@given(
    st.lists(st.tuples(st.floats(-0.005, 0.005), st.floats(-0.005, 0.005)), max_size=60),
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
)
def test_whatever_a_rover_with_slip_does_is_within_reach(belts, advance, efficiency):
    reach, x, y, heading = Reach(at()), 3.0, 0.0, 0.0
    for left, right in belts:
        reach = reach.driven(left, right, 0.115)
        heading += efficiency * (right - left) / 0.115
        x += advance * (left + right) / 2 * math.cos(heading)
        y += advance * (left + right) / 2 * math.sin(heading)
    assert reach.beyond(at(x, y, math.degrees(heading))) is None
