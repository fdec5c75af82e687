"""The motion model: exact where arithmetic is, honest where it must learn."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from executive.core.types import PoseEstimate
from executive.isc import attitude, correction, evidence_check, motion, prediction
from executive.isc.motion import (
    ADVANCE,
    DRIFT,
    YAW_EFFICIENCY,
    MotionNoise,
    MotionState,
)

GAUGE_M = 0.125
NOISE = MotionNoise()


def pose(
    x: float, y: float, heading: float, sigma_m: float = 0.001, sigma_rad: float = 0.002
) -> PoseEstimate:
    return PoseEstimate(
        time_s=0.0,
        position_site_m=(x, y, 0.0),
        quat_site_body=attitude.quat_from_heading_tilt(heading, 0.0, 0.0),
        covariance=np.diag([sigma_m**2] * 3 + [1e-6, 1e-6, sigma_rad**2]),
        source="markers",
        markers=4,
    )


def known(state: MotionState, advance: float, efficiency: float) -> MotionState:
    state = correction.reset_parameter(state, ADVANCE, advance, 1e-6)
    return correction.reset_parameter(state, YAW_EFFICIENCY, efficiency, 1e-6)


@given(st.floats(-math.pi, math.pi), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_quaternion_is_heading_then_pitch_then_roll(heading: float, roll: float, pitch: float) -> None:
    expected = Rotation.from_euler("ZYX", [heading, pitch, roll]).as_matrix()
    actual = Rotation.from_quat(attitude.quat_from_heading_tilt(heading, roll, pitch)).as_matrix()
    assert np.allclose(actual, expected, atol=1e-12)


@given(st.floats(-100.0, 100.0))
def test_wrapped_angle_is_the_same_direction(angle: float) -> None:
    wrapped = attitude.wrap_rad(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.isclose(math.cos(wrapped), math.cos(angle), abs_tol=1e-9)


def test_equal_belts_advance_straight_by_travel_times_advance() -> None:
    state = known(motion.start(pose(1.0, 2.0, 0.5), NOISE), 0.9, 0.5)
    moved = prediction.predict(state, 0.1, 0.1, GAUGE_M, 71.0, NOISE).pose()
    assert moved.x_m == pytest.approx(1.0 + 0.09 * math.cos(0.5))
    assert moved.y_m == pytest.approx(2.0 + 0.09 * math.sin(0.5))
    assert moved.heading_rad == pytest.approx(0.5)


def test_opposite_belts_turn_on_the_spot_by_the_efficiency() -> None:
    state = known(motion.start(pose(0.0, 0.0, 0.0), NOISE), 0.9, 0.5)
    moved = prediction.predict(state, -0.05, 0.05, GAUGE_M, 36.0, NOISE).pose()
    assert moved.heading_rad == pytest.approx(0.5 * 0.1 / GAUGE_M)
    assert math.hypot(moved.x_m, moved.y_m) < 1e-12


def test_standing_still_adds_no_uncertainty() -> None:
    state = motion.start(pose(0.0, 0.0, 0.0), NOISE)
    later = prediction.predict(state, 0.0, 0.0, GAUGE_M, 1000.0, NOISE)
    assert np.array_equal(later.covariance, state.covariance)
    assert later.time_s == 1000.0


def test_jacobian_agrees_with_finite_differences() -> None:
    state = motion.start(pose(0.3, -0.2, 0.7), NOISE)
    quiet = MotionNoise(
        position_m_per_sqrt_m=0,
        position_m_per_sqrt_rad=0,
        heading_rad_per_sqrt_m=0,
        heading_rad_per_sqrt_rad=0,
        advance_per_sqrt_m=0,
        yaw_efficiency_per_sqrt_rad=0,
        drift_rad_m_per_sqrt_m=0,
    )
    numeric = np.zeros((6, 6))
    for column in range(6):
        step = np.zeros(6)
        step[column] = 1e-6
        ends = []
        for sign in (1, -1):
            shifted = MotionState(0.0, state.mean + sign * step, np.zeros((6, 6)), 0.0, 0.0)
            ends.append(prediction.predict(shifted, 0.05, 0.08, GAUGE_M, 1.0, quiet).mean)
        numeric[:, column] = (ends[0] - ends[1]) / 2e-6
    moved = prediction.predict(state, 0.05, 0.08, GAUGE_M, 1.0, quiet)
    assert np.allclose(moved.covariance, numeric @ state.covariance @ numeric.T, atol=1e-9)


def test_filter_learns_how_the_soil_turns_and_slips() -> None:
    truth = {"advance": 0.8, "efficiency": 0.35, "drift": 0.15}
    rng = np.random.default_rng(5)
    x = y = heading = 0.0
    state = motion.start(pose(x, y, heading), NOISE)
    for _ in range(12):
        for left, right in ((-0.03, 0.03), (0.1, 0.1)):
            travel, rotation = (left + right) / 2, (right - left) / GAUGE_M
            turn = truth["efficiency"] * rotation + truth["drift"] * travel
            x += truth["advance"] * travel * math.cos(heading + turn / 2)
            y += truth["advance"] * travel * math.sin(heading + turn / 2)
            heading += turn
            state = prediction.predict(state, left, right, GAUGE_M, 0.0, NOISE)
            noisy = pose(*(np.array([x, y, heading]) + rng.normal(0, [0.001, 0.001, 0.002])))
            state = correction.correct(state, noisy, NOISE)
    assert state.advance == pytest.approx(truth["advance"], abs=0.04)
    assert state.yaw_efficiency == pytest.approx(truth["efficiency"], abs=0.04)
    assert state.drift_rad_m == pytest.approx(truth["drift"], abs=0.06)


def test_normalised_innovation_is_consistent_when_the_model_holds() -> None:
    rng = np.random.default_rng(11)
    squared = []
    for _ in range(400):
        state = motion.start(pose(0.0, 0.0, 0.0), NOISE)
        drawn = rng.multivariate_normal(state.mean, state.covariance)
        left, right = 0.06, 0.09
        travel, rotation = (left + right) / 2, (right - left) / GAUGE_M
        turn = drawn[YAW_EFFICIENCY] * rotation + drawn[DRIFT] * travel
        forward = drawn[ADVANCE] * travel
        x = drawn[0] + forward * math.cos(drawn[2] + turn / 2)
        y = drawn[1] + forward * math.sin(drawn[2] + turn / 2)
        heading = drawn[2] + turn
        spread = [
            NOISE.position_m_per_sqrt_m * math.sqrt(travel),
            NOISE.position_m_per_sqrt_rad * math.sqrt(rotation),
        ]
        position = rng.normal(0.0, math.hypot(*spread), 2)
        yaw = math.hypot(
            NOISE.heading_rad_per_sqrt_m * math.sqrt(travel),
            NOISE.heading_rad_per_sqrt_rad * math.sqrt(rotation),
        )
        moved = np.array([x, y, heading]) + np.array([*position, rng.normal(0, yaw)])
        fix = pose(*(moved + rng.normal(0, [1e-3, 1e-3, 2e-3])))
        predicted = prediction.predict(state, left, right, GAUGE_M, 1.0, NOISE)
        innovation, covariance = correction.innovate(predicted, fix)
        squared.append(innovation @ np.linalg.solve(covariance, innovation))
    assert np.mean(squared) == pytest.approx(3.0, abs=0.4)  # chi-square of 3, three sigma of the mean


def test_covariance_stays_symmetric_and_positive_over_a_long_trek() -> None:
    state = motion.start(pose(0.0, 0.0, 0.0), NOISE)
    for step in range(300):
        state = prediction.predict(state, 0.1, 0.101, GAUGE_M, float(step), NOISE)
        state = correction.correct(state, state.pose().on(None), NOISE)
    assert np.array_equal(state.covariance, state.covariance.T)
    assert np.linalg.eigvalsh(state.covariance).min() > 0.0


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"position_site_m": (math.nan, 0.0, 0.0)}, "the pose found is no number"),
        ({"quat_site_body": (0.0, 0.0, math.inf, 1.0)}, "the pose found is no number"),
        ({"covariance": np.full((6, 6), np.nan)}, "the pose found is no number"),
        ({"time_s": math.nan}, "the pose found is no number"),
        ({"time_s": 99.0}, "the pose found is 1 s older than the question"),
        ({"time_s": 100.0}, None),
    ],
)
def test_a_pose_that_is_no_number_or_old_says_nothing(change, why):
    pose = PoseEstimate(101.0, (1.0, 2.0, 0.0), (0.0, 0.0, 0.0, 1.0), np.eye(6), "markers")
    assert evidence_check.unusable(replace(pose, **change), since_s=100.0) == why


@given(st.floats(0.0005, 0.1), st.floats(0.001, 0.1), st.floats(-1.0, 1.0))
def test_a_fused_fix_is_no_less_certain_than_the_fix_and_lies_within_both(
    sigma_m: float, sigma_rad: float, luck: float
) -> None:
    start = motion.start(pose(10.0, 2.0, 0.5), NOISE)
    moved = prediction.predict(start, 0.1, 0.1, GAUGE_M, 71.0, NOISE)
    fix = pose(moved.pose().x_m + luck * sigma_m, moved.pose().y_m, 0.5, sigma_m, sigma_rad)
    found = correction.fuse(correction.correct(moved, fix, NOISE), fix)
    for i in (0, 1, 5):
        assert found.covariance[i, i] <= min(fix.covariance[i, i], moved.pose().covariance[i, i]) * (1 + 1e-6)
    assert np.linalg.eigvalsh(found.covariance)[0] > 0
    low, high = sorted((moved.pose().x_m, fix.x_m))
    slack = 0.2 * abs(luck) * sigma_m  # place and heading are correlated
    assert low - slack - 1e-9 <= found.x_m <= high + slack + 1e-9
    assert (found.source, found.markers, found.time_s) == (fix.source, fix.markers, fix.time_s)


def test_what_the_model_does_not_explain_is_where_the_fix_sees_it() -> None:
    state = motion.start(pose(1.0, 2.0, 0.5), NOISE)
    fix = pose(1.4, 1.8, -0.3, 0.05, 0.1)
    found = correction.fuse(correction.reset_pose(state, fix), fix)
    assert (found.x_m, found.y_m) == (fix.x_m, fix.y_m)
    assert found.heading_rad == pytest.approx(fix.heading_rad)
