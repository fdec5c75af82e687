"""The state of the motion model: a pose, and how this soil turns and slips.

`advance` is true travel per belt travel (1 minus slip), `yaw_efficiency` true rotation per the rotation that
the belts alone would give, `drift` the rotation per metre of belt travel that nobody commanded (lazy track,
side load).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.types import Array, PoseEstimate, PoseSource, frozen_array
from executive.isc.attitude import quat_from_heading_tilt

X, Y, HEADING, ADVANCE, YAW_EFFICIENCY, DRIFT = range(6)
PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
"""x, y and heading within the covariance of a pose."""


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
        planar = PLANAR
        covariance[planar] = self.covariance[:3, :3]
        return PoseEstimate(
            time_s=self.time_s,
            position_site_m=(float(self.mean[X]), float(self.mean[Y]), self.height_m),
            quat_site_body=quat_from_heading_tilt(float(self.mean[HEADING]), self.roll_rad, self.pitch_rad),
            covariance=covariance,
            source=self.source,
        )


def start(pose: PoseEstimate, noise: MotionNoise) -> MotionState:
    """The filter at a prior pose, with the prior of the soil."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = pose.covariance[PLANAR]
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
