"""A way-point is reached where two sigma of the estimate lie in its zone, and nowhere else."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core.arrival import arrival
from executive.core.types import Point, PoseEstimate, Reason
from executive.isc.attitude import quat_from_heading_tilt

TARGET = Point(3.0, 1.0)
LENGTHS = st.floats(0.001, 1.0)


def pose(away_m: float, sigma_m: float, bearing_rad: float = 0.0) -> PoseEstimate:
    x, y = TARGET.x_m + away_m * math.cos(bearing_rad), TARGET.y_m + away_m * math.sin(bearing_rad)
    covariance = np.diag([sigma_m**2, (sigma_m / 3) ** 2, 0.0, 0.0, 0.0, 0.0])
    return PoseEstimate(0.0, (x, y, 0.0), quat_from_heading_tilt(0.0, 0.0, 0.0), covariance, "test")


@given(LENGTHS, LENGTHS, LENGTHS, st.floats(-math.pi, math.pi))
def test_what_is_reached_lies_in_the_zone_with_two_sigma(
    away_m: float, sigma_m: float, within_m: float, bearing_rad: float
) -> None:
    judged = arrival(pose(away_m, sigma_m, bearing_rad), TARGET, within_m).reason
    spare_m = within_m - away_m - 2 * sigma_m
    if abs(spare_m) > 1e-9:
        assert (judged is Reason.DONE) == (spare_m > 0)
    if abs(away_m - within_m) > 1e-9:
        assert (judged is Reason.UNEXPECTED) == (away_m > within_m)


@given(LENGTHS, st.floats(1.0, 10.0), st.floats(1.0, 10.0))
def test_a_finer_estimate_or_a_wider_zone_never_undoes_an_arrival(
    within_m: float, finer: float, wider: float
) -> None:
    reached = pose(0.3 * within_m, 0.3 * within_m)
    assert arrival(reached, TARGET, within_m).ok
    assert arrival(pose(0.3 * within_m, 0.3 * within_m / finer), TARGET, within_m * wider).ok


def test_no_sigma_is_small_enough_where_it_exceeds_half_the_tolerance() -> None:
    """A fix good to 70 mm says nothing of a zone of 30 mm, were it in its very middle."""
    assert arrival(pose(0.0, 0.070), TARGET, 0.030).reason is Reason.ARRIVAL_UNCERTAIN


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_pose_that_is_no_number_carries_nothing(value: float) -> None:
    assert not arrival(pose(value, 0.001), TARGET, 0.03).ok
    assert not arrival(pose(0.0, value), TARGET, 0.03).ok
