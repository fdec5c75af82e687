"""The motion model: predicts the pose from belt travel.

One extended Kalman filter over (x, y, heading, advance, yaw efficiency, drift); `correction` holds its other
half. Immutable: every function returns a new `MotionState`.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from executive.core.types import PoseSource, TiltReading, frozen_array
from executive.isc.attitude import wrap_rad
from executive.isc.motion import ADVANCE, DRIFT, HEADING, YAW_EFFICIENCY, MotionNoise, MotionState, X, Y


def predict(
    state: MotionState, left_m: float, right_m: float, gauge_m: float, time_s: float, noise: MotionNoise
) -> MotionState:
    """The state after the belts moved by these travels (EKF prediction)."""
    if left_m == 0.0 and right_m == 0.0:
        return replace(state, time_s=time_s)
    travel, rotation = (left_m + right_m) / 2, (right_m - left_m) / gauge_m
    mean = state.mean.copy()
    turn = mean[YAW_EFFICIENCY] * rotation + mean[DRIFT] * travel
    middle = mean[HEADING] + turn / 2
    forward = mean[ADVANCE] * travel
    c, s = math.cos(middle), math.sin(middle)
    mean[X] += forward * c
    mean[Y] += forward * s
    mean[HEADING] = wrap_rad(mean[HEADING] + turn)

    jacobian = np.eye(6)
    jacobian[HEADING, YAW_EFFICIENCY], jacobian[HEADING, DRIFT] = rotation, travel
    jacobian[X, ADVANCE], jacobian[Y, ADVANCE] = travel * c, travel * s
    for column, factor in ((HEADING, 1.0), (YAW_EFFICIENCY, rotation / 2), (DRIFT, travel / 2)):
        jacobian[X, column] = -forward * s * factor
        jacobian[Y, column] = forward * c * factor
    metres, radians = abs(travel), abs(rotation)
    position = noise.position_m_per_sqrt_m**2 * metres + noise.position_m_per_sqrt_rad**2 * radians
    growth = [
        position,
        position,
        noise.heading_rad_per_sqrt_m**2 * metres + noise.heading_rad_per_sqrt_rad**2 * radians,
        noise.advance_per_sqrt_m**2 * metres,
        noise.yaw_efficiency_per_sqrt_rad**2 * radians,
        noise.drift_rad_m_per_sqrt_m**2 * metres,
    ]
    covariance = jacobian @ state.covariance @ jacobian.T + np.diag(growth)
    return replace(
        state,
        time_s=time_s,
        mean=frozen_array(mean, (6,)),
        covariance=frozen_array(covariance, (6, 6)),
        height_sigma_m=math.hypot(state.height_sigma_m, noise.climb_per_m * abs(forward)),
        source=PoseSource.PREDICTION,
    )


def level(state: MotionState, tilt: TiltReading) -> MotionState:
    """The state with the attitude that the inclinometers report."""
    return replace(state, roll_rad=tilt.roll_rad, pitch_rad=tilt.pitch_rad)
