"""The corridor of a segment is a capsule: beside it and past its ends alike."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core import corridor
from executive.core.types import Point, PoseEstimate, Segment
from executive.isc.attitude import quat_from_heading_tilt

METRES = st.floats(-10.0, 10.0)
SIGMAS = st.floats(0.0, 0.2)


@st.composite
def segments(draw: st.DrawFn) -> Segment:
    x, y, bearing = draw(METRES), draw(METRES), draw(st.floats(-math.pi, math.pi))
    length = draw(st.floats(0.1, 5.0))
    end = Point(x + length * math.cos(bearing), y + length * math.sin(bearing))
    return Segment(Point(x, y), end, 0.03, draw(st.floats(0.05, 1.0)), 0.03)


def pose(x_m: float, y_m: float, sigma_x_m: float = 0.0, sigma_y_m: float = 0.0) -> PoseEstimate:
    covariance = np.diag([sigma_x_m**2, sigma_y_m**2, 0.0, 0.0, 0.0, 0.0])
    return PoseEstimate(0.0, (x_m, y_m, 0.0), quat_from_heading_tilt(0.0, 0.0, 0.0), covariance, "test")


def at(segment: Segment, along_m: float, cross_m: float) -> tuple[float, float]:
    c, s = math.cos(segment.bearing_rad), math.sin(segment.bearing_rad)
    return segment.start.x_m + c * along_m - s * cross_m, segment.start.y_m + s * along_m + c * cross_m


@given(segments(), st.floats(0.0, 1.0), METRES)
def test_beside_a_segment_the_distance_is_the_cross_track_error(
    segment: Segment, share: float, cross_m: float
) -> None:
    x, y = at(segment, share * segment.length_m, cross_m)
    assert corridor.distance_m(segment, x, y) == pytest.approx(abs(cross_m), abs=1e-9)


@given(segments(), st.floats(0.0, 10.0), METRES, st.booleans())
def test_past_either_end_the_distance_is_that_from_the_end(
    segment: Segment, past_m: float, cross_m: float, ahead: bool
) -> None:
    x, y = at(segment, segment.length_m + past_m if ahead else -past_m, cross_m)
    assert corridor.distance_m(segment, x, y) == pytest.approx(math.hypot(past_m, cross_m), abs=1e-9)


@given(segments(), METRES, METRES)
def test_a_segment_driven_the_other_way_has_the_same_corridor(segment: Segment, x: float, y: float) -> None:
    back = replace(segment, start=segment.end, end=segment.start)
    assert corridor.distance_m(back, x, y) == pytest.approx(corridor.distance_m(segment, x, y), abs=1e-9)


@given(segments(), METRES, METRES, SIGMAS, SIGMAS, st.floats(0.0, 4.0))
def test_uncertainty_never_makes_room(
    segment: Segment, x: float, y: float, sx: float, sy: float, sigmas: float
) -> None:
    exact, unsure = pose(x, y), pose(x, y, sx, sy)
    assert corridor.room_m(unsure, segment, sigmas) <= corridor.room_m(exact, segment, sigmas) + 1e-9
    assert corridor.room_m(exact, segment, sigmas) == pytest.approx(
        segment.off_track_m - corridor.distance_m(segment, x, y), abs=1e-9
    )


@given(segments(), st.floats(0.3, 0.7), st.floats(-0.4, 0.4), st.floats(0.0, 0.02))
def test_beside_a_segment_the_room_is_margin_less_error_less_deviation_across(
    segment: Segment, share: float, cross_m: float, sigma_m: float
) -> None:
    where = pose(*at(segment, share * segment.length_m, cross_m), sigma_m, sigma_m)
    told = segment.off_track_m - abs(cross_m) - 2.0 * sigma_m
    if 2.0 * sigma_m < 0.3 * segment.length_m:  # so that no end of the ellipse lies past an end
        assert corridor.room_m(where, segment, 2.0) == pytest.approx(told, abs=1e-9)


def test_a_rover_past_the_end_by_more_than_the_margin_is_out_of_the_corridor() -> None:
    segment = Segment(Point(2.4, 0.0), Point(2.8, 0.0), 0.03, 0.25, 0.03)
    assert (
        corridor.room_m(pose(3.04, 0.0), segment, 2.0) > 0.0 > corridor.room_m(pose(3.06, 0.0), segment, 2.0)
    )
    assert (
        corridor.room_m(pose(2.16, 0.0), segment, 2.0) > 0.0 > corridor.room_m(pose(2.14, 0.0), segment, 2.0)
    )


def test_along_an_end_the_deviation_along_counts() -> None:
    segment = Segment(Point(2.4, 0.0), Point(2.8, 0.0), 0.03, 0.25, 0.03)
    assert corridor.room_m(pose(3.0, 0.0, 0.03, 0.0), segment, 2.0) < 0.0
    assert corridor.room_m(pose(2.6, 0.0, 0.03, 0.0), segment, 2.0) == pytest.approx(0.25)


@pytest.mark.parametrize("x_m", [math.nan, math.inf])
def test_a_pose_that_is_no_number_has_no_room(x_m: float) -> None:
    segment = Segment(Point(2.4, 0.0), Point(2.8, 0.0), 0.03, 0.25, 0.03)
    assert corridor.room_m(pose(x_m, 0.0), segment, 2.0) == -math.inf
    assert corridor.room_m(pose(2.5, 0.0, math.nan), segment, 2.0) == -math.inf
