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


@pytest.mark.parametrize(("moved_m", "possible"), [(1.17, True), (1.19, False)])
def test_belts_carry_no_more_than_a_seventh_beyond_their_count(moved_m, possible):
    """15 % for stretch and lost counts, 30 mm for a stone that gives way: 1.18 m on 1 m of belts."""
    reach = Reach(at(0.0, sigma=0.0), travel_m=1.0)
    assert (reach.beyond(at(moved_m, sigma=0.0)) is None) is possible


@pytest.mark.parametrize(("turned_deg", "possible"), [(73.5, True), (74.3, False)])
def test_belts_turn_no_more_than_they_count_with_their_stretch(turned_deg, possible):
    """8 degrees to spare and 15 % of 1 rad: 73.9 degrees."""
    reach = Reach(at(sigma=0.0), rotation_rad=1.0)
    assert (reach.beyond(at(heading_deg=turned_deg, sigma=0.0)) is None) is possible


@pytest.mark.parametrize(("turned_deg", "possible"), [(42.0, True), (43.0, False)])
def test_rough_ground_turns_a_straight_drive_by_a_bounded_angle_a_metre(turned_deg, possible):
    """8 degrees to spare and 0.6 rad for 1 m: 42.4 degrees."""
    reach = Reach(at(sigma=0.0), travel_m=1.0)
    assert (reach.beyond(at(heading_deg=turned_deg, sigma=0.0)) is None) is possible


@pytest.mark.parametrize(("sigmas", "possible"), [(3.9, True), (4.1, False)])
def test_four_sigma_of_both_fixes_are_allowed_for(sigmas, possible):
    """More than an honest fix errs by in a mission; less would refuse honest ones."""
    last, fix = at(0.0, sigma=0.03), at(0.0, sigma=0.04)
    sigma_m = math.hypot(last.sigma_position_m, fix.sigma_position_m)
    moved = at(0.03 + sigmas * sigma_m, sigma=0.04)
    assert (Reach(last).beyond(moved) is None) is possible
