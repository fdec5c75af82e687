"""What is driven after a fix that contradicts the belts counts by the belts, until a drive settles it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core.types import Point, PoseEstimate, Segment
from executive.isc.attitude import quat_from_heading_tilt
from executive.isc.correction import reset_pose
from executive.isc.doubt import Doubt
from executive.isc.motion import MotionNoise, start

GAUGE_M = 0.13
NOISE = MotionNoise()
SEGMENT = Segment(Point(2.0, 0.0), Point(4.0, 0.0), 0.03, 0.25, 0.03)
LEGS = st.lists(st.floats(0.03, 0.12), min_size=1, max_size=6)


def fix(x_m: float, y_m: float = 0.0, heading_rad: float = 0.0) -> PoseEstimate:
    covariance = np.diag([0.003**2, 0.003**2, 0.01**2, 0.01**2, 0.01**2, 0.01**2])
    quat = quat_from_heading_tilt(heading_rad, 0.0, 0.0)
    return PoseEstimate(0.0, (x_m, y_m, 0.0), quat, covariance, "markers")


STATE = start(fix(2.0), replace(NOISE, prior_advance=(1.0, 0.05)))


def driven(doubt: Doubt, way_m: float) -> Doubt:
    return doubt.driven(way_m, way_m, GAUGE_M, 0.0, NOISE)


def contradicted(doubt: Doubt, x_m: float) -> Doubt:
    """After a fix that says that the rover stands still at `x_m`."""
    return doubt.after_fix(fix(x_m), False, reset_pose(doubt.belts, fix(x_m)))


@given(LEGS)
def test_what_is_driven_blind_adds_up_whatever_later_fixes_say(legs_m: list[float]) -> None:
    doubt = contradicted(driven(Doubt(STATE), 0.2), 2.0)
    for leg_m in legs_m:
        doubt = contradicted(driven(doubt, leg_m), 2.0)
        doubt = driven(doubt, -leg_m)  # back and forth is no way undone
        doubt = contradicted(doubt, 2.0) if not doubt._agrees(fix(2.0)) else doubt
    assert doubt.way_m == pytest.approx(0.2 + 2 * math.fsum(legs_m))
    assert (doubt.exceeded(SEGMENT) is not None) == (doubt.way_m > 2 * SEGMENT.off_track_m)


def test_the_place_by_the_belts_may_leave_the_corridor_while_the_fixes_stand_still() -> None:
    doubt = contradicted(driven(Doubt(STATE), 0.1), 2.0)
    assert doubt.room_m(SEGMENT, 2.0) > 0.0
    aside = replace(doubt, belts=start(fix(2.1, 0.15, math.pi / 2), NOISE))
    assert driven(aside, 0.12).room_m(SEGMENT, 2.0) < 0.0


def test_without_contradiction_there_is_no_doubt() -> None:
    doubt = driven(Doubt(STATE), 3.0)
    assert doubt.room_m(SEGMENT, 2.0) == math.inf
    assert doubt.exceeded(SEGMENT) is None


def test_looking_twice_at_rest_settles_nothing() -> None:
    doubt = contradicted(driven(Doubt(STATE), 0.2), 2.0)
    assert doubt.after_fix(fix(2.0), True, STATE).open


def test_a_drive_that_went_as_the_model_says_settles_it() -> None:
    """A rover that a rock held backs off: the fix moves as the belts do, so the fix before was right."""
    doubt = driven(contradicted(driven(Doubt(STATE), 0.2), 2.0), -0.2)
    settled = doubt.after_fix(fix(1.8), True, STATE)
    assert (settled.open, settled.way_m) == (False, 0.0)


def test_a_fix_where_the_belts_say_settles_it() -> None:
    """The old fixes end: the new one lies where the rover was driven."""
    doubt = driven(contradicted(driven(Doubt(STATE), 0.2), 2.0), 0.1)
    assert not doubt.after_fix(fix(2.3), False, STATE).open


def test_a_fix_that_is_refused_opens_the_doubt() -> None:
    assert driven(Doubt(STATE).refused(), 0.6).exceeded(SEGMENT) is not None
