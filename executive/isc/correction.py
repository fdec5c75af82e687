"""The motion model held against fixes: learnt from, reset, or believed less."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from executive.core.types import Array, PoseEstimate, frozen_array
from executive.isc.attitude import quat_from_heading_tilt, wrap_rad
from executive.isc.motion import ADVANCE, HEADING, PLANAR, YAW_EFFICIENCY, MotionNoise, MotionState


def innovate(state: MotionState, fix: PoseEstimate) -> tuple[Array, Array]:
    """Innovation (3,) of a fix in (x, y, heading) and its covariance (3, 3)."""
    measured = np.array([fix.x_m, fix.y_m, fix.heading_rad])
    innovation = measured - state.mean[:3]
    innovation[2] = wrap_rad(float(innovation[2]))
    return innovation, state.covariance[:3, :3] + fix.covariance[PLANAR]


def correct(state: MotionState, fix: PoseEstimate, noise: MotionNoise) -> MotionState:
    """The state after a fix (EKF update); the soil parameters learn through their cross-covariances."""
    innovation, spread = innovate(state, fix)
    gain = state.covariance[:, :3] @ np.linalg.inv(spread)
    mean = state.mean + gain @ innovation
    mean[HEADING] = wrap_rad(float(mean[HEADING]))
    mean[ADVANCE] = np.clip(mean[ADVANCE], *noise.range_of_advance)
    mean[YAW_EFFICIENCY] = np.clip(mean[YAW_EFFICIENCY], *noise.range_of_yaw_efficiency)
    keep = np.eye(6)
    keep[:, :3] -= gain
    measured = fix.covariance[PLANAR]
    covariance = keep @ state.covariance @ keep.T + gain @ measured @ gain.T  # Joseph form: stays symmetric
    return replace(
        state,
        time_s=fix.time_s,
        mean=frozen_array(mean, (6,)),
        covariance=frozen_array((covariance + covariance.T) / 2, (6, 6)),
        height_m=fix.position_site_m[2],
        height_sigma_m=math.sqrt(fix.covariance[2, 2]),
        source=fix.source,
    )


def fuse(state: MotionState, fix: PoseEstimate) -> PoseEstimate:
    """A fix with the place and heading of the filter that took it in: near by its own, far away, where the
    belts know the way since the last one better than eyes do, rather the prediction's."""
    planar, rest = PLANAR, np.ix_([2, 3, 4], [2, 3, 4])
    covariance = np.zeros((6, 6))
    covariance[planar], covariance[rest] = state.covariance[:3, :3], fix.covariance[rest]
    x, y, heading = state.mean[:3].tolist()
    quat = quat_from_heading_tilt(heading, state.roll_rad, state.pitch_rad)
    place = (x, y, fix.position_site_m[2])
    return replace(fix, position_site_m=place, quat_site_body=quat, covariance=covariance)


def reset_pose(state: MotionState, fix: PoseEstimate) -> MotionState:
    """The state put at a fix without learning from it: for a move that the model does not explain."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = fix.covariance[PLANAR]
    covariance[3:, 3:] = state.covariance[3:, 3:]
    mean = state.mean.copy()
    mean[:3] = fix.x_m, fix.y_m, fix.heading_rad
    return replace(
        state,
        time_s=fix.time_s,
        mean=frozen_array(mean, (6,)),
        covariance=frozen_array(covariance, (6, 6)),
        height_m=fix.position_site_m[2],
        height_sigma_m=math.sqrt(fix.covariance[2, 2]),
        source=fix.source,
    )


def inflate(state: MotionState, along_m: float, across_m: float, heading_rad: float) -> MotionState:
    """The state with its pose less certain by these standard deviations, after a move that went wrong."""
    c, s = math.cos(state.mean[HEADING]), math.sin(state.mean[HEADING])
    body = np.array([[c, -s], [s, c]])
    covariance = state.covariance.copy()
    covariance[:2, :2] += body @ np.diag([along_m**2, across_m**2]) @ body.T
    covariance[HEADING, HEADING] += heading_rad**2
    return replace(state, covariance=frozen_array(covariance, (6, 6)))


def reset_parameter(state: MotionState, parameter: int, value: float, sigma: float) -> MotionState:
    """The state with one soil parameter set afresh, its correlations forgotten."""
    mean, covariance = state.mean.copy(), state.covariance.copy()
    mean[parameter] = value
    covariance[parameter, :] = covariance[:, parameter] = 0.0
    covariance[parameter, parameter] = sigma**2
    return replace(state, mean=frozen_array(mean, (6,)), covariance=frozen_array(covariance, (6, 6)))
