"""Guidance: turn first, correct only where the margins say so, never towards the off-track margin."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core.types import (
    Point,
    PoseEstimate,
    Reason,
    Segment,
)
from executive.isc import correction
from executive.isc.attitude import wrap_rad
from executive.isc.motion import DRIFT, MotionNoise, start
from executive.isc.prediction import predict
from executive.navigation import guidance
from executive.navigation.guidance import GuidanceLimits
from tests.executive.isc.test_prediction import pose

SEGMENT = Segment(Point(0.0, 0.0), Point(1.0, 0.0), on_track_m=0.03, off_track_m=0.25, tolerance_m=0.03)
GAUGE_M = 0.125


def leg(at: PoseEstimate, segment: Segment = SEGMENT, longest_m: float = 0.1):
    motion = start(at, MotionNoise())
    return guidance.plan_leg(motion, at, segment.end, segment, longest_m, GAUGE_M, GuidanceLimits())


def after(at: PoseEstimate, belts: guidance.Belts) -> PoseEstimate:
    motion = start(at, MotionNoise())
    return predict(motion, belts.left_m, belts.right_m, GAUGE_M, 1.0, MotionNoise()).pose()


def test_on_track_and_on_course_the_belts_run_alike() -> None:
    planned = leg(pose(0.2, 0.0, 0.0))
    assert planned.ok
    assert planned.value.left_m == pytest.approx(planned.value.right_m)
    assert after(pose(0.2, 0.0, 0.0), planned.value).x_m == pytest.approx(0.3)


def test_between_the_margins_the_leg_turns_back_to_the_target() -> None:
    at = pose(0.2, 0.1, 0.0)
    planned = leg(at)
    assert planned.ok
    assert after(at, planned.value).heading_rad == pytest.approx(math.atan2(-0.1, 0.8), abs=1e-9)


def test_a_small_miss_inside_the_on_track_margin_is_left_alone() -> None:
    planned = leg(pose(0.2, 0.005, -0.005))
    assert planned.value.left_m == pytest.approx(planned.value.right_m)


def test_a_large_heading_error_asks_for_a_turn_on_the_spot() -> None:
    assert leg(pose(0.2, 0.0, 0.5)).reason is Reason.OFF_HEADING


@given(
    remaining_m=st.floats(0.001, 0.3),
    error_rad=st.floats(-3.1, 3.1),
    tolerance_m=st.sampled_from([0.01, 0.025, 0.1]),
)
def test_no_leg_is_refused_for_a_heading_that_the_tree_takes_for_good(
    remaining_m, error_rad, tolerance_m
) -> None:
    """As `trek_to` asks: `facing`, within 10 degrees or a miss of 6 mm."""
    at = pose(1.0 - remaining_m * math.cos(error_rad), -remaining_m * math.sin(error_rad), 0.0)
    miss_m = remaining_m * abs(math.sin(error_rad))
    faced = abs(error_rad) <= math.radians(10.0) or (abs(error_rad) < math.pi / 2 and miss_m <= 0.006)
    planned = leg(at, replace(SEGMENT, tolerance_m=tolerance_m))
    assert not (faced and planned.reason is Reason.OFF_HEADING)


def test_a_rover_that_would_miss_a_near_target_by_little_drives_straight_on() -> None:
    planned = leg(pose(0.98, 0.005, 0.0))
    assert planned.ok
    assert planned.value.left_m == pytest.approx(planned.value.right_m)


def test_beyond_the_off_track_margin_there_is_no_leg() -> None:
    assert leg(pose(0.2, 0.26, -0.1)).reason in (Reason.OFF_TRACK, Reason.OFF_HEADING)
    assert leg(pose(0.2, 0.249, -0.2)).reason is Reason.OFF_TRACK


def test_uncertainty_counts_towards_the_margin() -> None:
    assert leg(pose(0.2, 0.2, -0.2)).ok
    assert leg(pose(0.2, 0.2, -0.2, sigma_m=0.03)).reason is Reason.OFF_TRACK


def test_the_last_leg_ends_at_the_target() -> None:
    at = pose(0.95, 0.0, 0.0)
    assert after(at, leg(at).value).x_m == pytest.approx(1.0)


@given(st.floats(0.0, 0.9), st.floats(-0.2, 0.2), st.floats(-0.19, 0.19))
def test_a_planned_leg_never_ends_beyond_the_margin(x: float, y: float, heading: float) -> None:
    at = pose(x, y, heading)
    planned = leg(at)
    if planned.ok:
        end = after(at, planned.value)
        assert abs(SEGMENT.offset(end.x_m, end.y_m).cross_m) < SEGMENT.off_track_m


@given(st.floats(-math.pi, math.pi))
def test_a_turn_ends_at_the_angle_asked(angle: float) -> None:
    at = pose(0.0, 0.0, 0.3)
    motion = start(at, MotionNoise())
    turned = after(at, guidance.turn(motion, angle, GAUGE_M))
    assert wrap_rad(turned.heading_rad - 0.3 - angle) == pytest.approx(0.0, abs=1e-9)


def test_a_lazy_track_is_fed_forward() -> None:
    motion = correction.reset_parameter(start(pose(0, 0, 0), MotionNoise()), DRIFT, 0.2, 0.01)
    belts = guidance.straight(motion, 0.1, 0.0, GAUGE_M)
    moved = predict(motion, belts.left_m, belts.right_m, GAUGE_M, 1.0, MotionNoise())
    assert moved.pose().heading_rad == pytest.approx(0.0, abs=1e-9)
    assert belts.left_m > belts.right_m


def test_a_target_passed_nearby_is_an_overshoot() -> None:
    segment = replace(SEGMENT, end=Point(0.5, 0.0))
    assert leg(pose(0.55, 0.0, 0.0), segment).reason is Reason.OVERSHOOT


def test_a_turn_is_cut_short_to_as_much_belt_travel_as_there_is_room() -> None:
    turn = guidance.Belts(-0.3, 0.3)
    assert guidance.within_room(turn, 0.05) == guidance.Belts(-0.05, 0.05)
    assert guidance.within_room(turn, 0.4) == turn
    assert guidance.within_room(turn, -0.02) == guidance.Belts(0.0, 0.0)
    assert guidance.within_room(guidance.Belts(0.0, 0.0), 0.0) == guidance.Belts(0.0, 0.0)
