"""The motion model: predicts the pose from belt travel, and learns how this soil turns and slips.

One extended Kalman filter over (x, y, heading, advance, yaw efficiency, drift). `advance` is true travel
per belt travel (1 minus slip), `yaw_efficiency` true rotation per the rotation that the belts alone would
give, `drift` the rotation per metre of belt travel that nobody commanded (lazy track, side load).
Immutable: every function returns a new `MotionState`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from executive.core.types import (
    Array,
    PoseEstimate,
    PoseSource,
    Quat,
    TiltReading,
    frozen_array,
)

X, Y, HEADING, ADVANCE, YAW_EFFICIENCY, DRIFT = range(6)


@dataclass(frozen=True)
class MotionNoise:
    """How fast the truth may leave the prediction; variances grow with belt travel and belt rotation."""

    prior_advance: tuple[float, float] = (0.95, 0.06)  # mean, sigma
    prior_yaw_efficiency: tuple[float, float] = (0.55, 0.20)
    prior_drift_rad_m: tuple[float, float] = (0.0, 0.10)
    position_m_per_sqrt_m: float = 0.010
    position_m_per_sqrt_rad: float = 0.006
    heading_rad_per_sqrt_m: float = 0.030
    heading_rad_per_sqrt_rad: float = 0.040
    advance_per_sqrt_m: float = 0.05
    yaw_efficiency_per_sqrt_rad: float = 0.05
    drift_rad_m_per_sqrt_m: float = 0.05
    climb_per_m: float = 0.25  # sigma of the height change per metre of travel
    range_of_advance: tuple[float, float] = (0.2, 1.2)
    range_of_yaw_efficiency: tuple[float, float] = (0.08, 1.5)


@dataclass(frozen=True, eq=False)
class MotionState:
    """Mean (6,) and covariance (6, 6) of the filter, plus the height and attitude carried along."""

    time_s: float
    mean: Array
    covariance: Array
    height_m: float
    height_sigma_m: float
    roll_rad: float = 0.0
    pitch_rad: float = 0.0
    source: str = PoseSource.PRIOR

    @property
    def advance(self) -> float:
        return float(self.mean[ADVANCE])

    @property
    def yaw_efficiency(self) -> float:
        return float(self.mean[YAW_EFFICIENCY])

    @property
    def drift_rad_m(self) -> float:
        return float(self.mean[DRIFT])

    def pose(self) -> PoseEstimate:
        """The pose part as an estimate; roll and pitch are the inclinometers' last word."""
        covariance = np.diag([0.0, 0.0, self.height_sigma_m**2, 0.005**2, 0.005**2, 0.0])
        planar = np.ix_([0, 1, 5], [0, 1, 5])
        covariance[planar] = self.covariance[:3, :3]
        return PoseEstimate(
            time_s=self.time_s,
            position_site_m=(float(self.mean[X]), float(self.mean[Y]), self.height_m),
            quat_site_body=quat_from_heading_tilt(float(self.mean[HEADING]), self.roll_rad, self.pitch_rad),
            covariance=covariance,
            source=self.source,
        )


def wrap_rad(angle_rad: float) -> float:
    """The same angle within (-pi, pi]."""
    return math.pi - (math.pi - angle_rad) % (2 * math.pi)


def quat_from_heading_tilt(heading_rad: float, roll_rad: float, pitch_rad: float) -> Quat:
    """Quaternion (x, y, z, w) of R = Rz(heading) Ry(pitch) Rx(roll)."""
    ch, sh = math.cos(heading_rad / 2), math.sin(heading_rad / 2)
    cp, sp = math.cos(pitch_rad / 2), math.sin(pitch_rad / 2)
    cr, sr = math.cos(roll_rad / 2), math.sin(roll_rad / 2)
    return (
        sr * cp * ch - cr * sp * sh,
        cr * sp * ch + sr * cp * sh,
        cr * cp * sh - sr * sp * ch,
        cr * cp * ch + sr * sp * sh,
    )


def start(pose: PoseEstimate, noise: MotionNoise) -> MotionState:
    """The filter at a prior pose, with the prior of the soil."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = pose.covariance[np.ix_([0, 1, 5], [0, 1, 5])]
    priors = (noise.prior_advance, noise.prior_yaw_efficiency, noise.prior_drift_rad_m)
    for index, (_, sigma) in enumerate(priors, start=ADVANCE):
        covariance[index, index] = sigma**2
    return MotionState(
        time_s=pose.time_s,
        mean=frozen_array([pose.x_m, pose.y_m, pose.heading_rad, *(mean for mean, _ in priors)], (6,)),
        covariance=frozen_array(covariance, (6, 6)),
        height_m=pose.position_site_m[2],
        height_sigma_m=math.sqrt(pose.covariance[2, 2]),
        source=pose.source,
    )


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
    measured = fix.covariance[np.ix_([0, 1, 5], [0, 1, 5])]
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


def innovate(state: MotionState, fix: PoseEstimate) -> tuple[Array, Array]:
    """Innovation (3,) of a fix in (x, y, heading) and its covariance (3, 3)."""
    measured = np.array([fix.x_m, fix.y_m, fix.heading_rad])
    innovation = measured - state.mean[:3]
    innovation[2] = wrap_rad(float(innovation[2]))
    return innovation, state.covariance[:3, :3] + fix.covariance[np.ix_([0, 1, 5], [0, 1, 5])]


def unusable(fix: PoseEstimate, since_s: float) -> str | None:
    """Why an estimate that was asked for at `since_s` says nothing at all; None if it may be weighed."""
    numbers = np.array([*fix.position_site_m, *fix.quat_site_body, fix.time_s])
    if not (np.isfinite(numbers).all() and np.isfinite(fix.covariance).all()):
        return "the pose found is no number"
    if fix.time_s < since_s:
        return f"the pose found is {since_s - fix.time_s:.0f} s older than the question"
    return None


def joined(state: MotionState, fix: PoseEstimate) -> PoseEstimate:
    """A fix with the place and heading of the filter that took it in: near by its own, far away, where the
    belts know the way since the last one better than eyes do, rather the prediction's."""
    planar, rest = np.ix_([0, 1, 5], [0, 1, 5]), np.ix_([2, 3, 4], [2, 3, 4])
    covariance = np.zeros((6, 6))
    covariance[planar], covariance[rest] = state.covariance[:3, :3], fix.covariance[rest]
    x, y, heading = state.mean[:3].tolist()
    quat = quat_from_heading_tilt(heading, state.roll_rad, state.pitch_rad)
    place = (x, y, fix.position_site_m[2])
    return replace(fix, position_site_m=place, quat_site_body=quat, covariance=covariance)


def relocate(state: MotionState, fix: PoseEstimate) -> MotionState:
    """The state put at a fix without learning from it: for a move that the model does not explain."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = fix.covariance[np.ix_([0, 1, 5], [0, 1, 5])]
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


def doubt(state: MotionState, along_m: float, across_m: float, heading_rad: float) -> MotionState:
    """The state with its pose less certain by these standard deviations, after a move that went wrong."""
    c, s = math.cos(state.mean[HEADING]), math.sin(state.mean[HEADING])
    body = np.array([[c, -s], [s, c]])
    covariance = state.covariance.copy()
    covariance[:2, :2] += body @ np.diag([along_m**2, across_m**2]) @ body.T
    covariance[HEADING, HEADING] += heading_rad**2
    return replace(state, covariance=frozen_array(covariance, (6, 6)))


def adopt(state: MotionState, parameter: int, value: float, sigma: float) -> MotionState:
    """The state with one soil parameter set afresh, its correlations forgotten."""
    mean, covariance = state.mean.copy(), state.covariance.copy()
    mean[parameter] = value
    covariance[parameter, :] = covariance[:, parameter] = 0.0
    covariance[parameter, parameter] = sigma**2
    return replace(state, mean=frozen_array(mean, (6,)), covariance=frozen_array(covariance, (6, 6)))
