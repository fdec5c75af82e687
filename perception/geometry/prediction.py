"""What the prediction says about the next look: state of the chain, gates, and how wide it is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.types import Array, PoseEstimate, Vec2
from perception.geometry.body import Transform
from perception.geometry.chain import Chain, ChainState, body_transform
from perception.geometry.pose import Prior, chi2_limit
from perception.geometry.rotation import (
    log_map,
    rot_x,
    rot_y,
    rot_z,
)

# A planar prediction knows little of the ground ahead: what terrain adds to height, roll and pitch.
_TERRAIN_HEIGHT_SIGMA_M = 0.02
_TERRAIN_TILT_SIGMA_RAD = math.radians(1.0)
_FLOOR = np.diag([1e-4**2] * 3 + [1e-4**2] * 3)
_PLANAR = [0, 1, 5]  # x, y, heading: what the gate looks at
_GATE = 1 - 1e-6
_NOTHING_KNOWN = 1e3  # m and rad
_WIDE_POSITION_M = 0.5
_WIDE_HEADING_RAD = math.radians(45.0)


@dataclass(frozen=True, eq=False)
class Expectation:
    """Where the rover is expected, with what a look must allow for."""

    state: ChainState
    covariance: Array

    @property
    def prior(self) -> Prior:
        return Prior(self.state.site_body, self.covariance)

    @property
    def surface(self) -> Prior:
        """The height of the ground alone, all that a fix may take from what it is to be held against."""
        return surface_of(self.prior)

    @property
    def wide(self) -> bool:
        """Whether the prediction says too little to gate a fix with."""
        position = math.sqrt(float(np.linalg.eigvalsh(self.covariance[:2, :2])[-1]))
        return position > _WIDE_POSITION_M or math.sqrt(self.covariance[5, 5]) > _WIDE_HEADING_RAD

    def distance2(self, body: Transform) -> float:
        """Squared distance of a body from here in the ground's plane and heading, in sigmas."""
        off = self._off(body)
        return float(off @ np.linalg.solve(self.covariance[np.ix_(_PLANAR, _PLANAR)], off))

    def _off(self, body: Transform) -> Array:
        """x, y [m] and heading [rad] of a body off the expected ones."""
        here = self.state.site_body
        turn = log_map(body.rotation @ here.rotation.T)
        return np.concatenate([body.position_m - here.position_m, turn])[_PLANAR]

    def misfit(self, body: Transform, covariance: Array) -> str:
        """Why a body with this covariance (6, 6) is too far from the prediction to be believed, or empty."""
        if self.wide:
            return ""
        off = self._off(body)
        P = (self.covariance + covariance)[np.ix_(_PLANAR, _PLANAR)]
        distance = float(off @ np.linalg.solve(P, off))
        if distance <= chi2_limit(len(_PLANAR), _GATE):
            return ""
        return (
            f"fix {math.hypot(off[0], off[1]) * 1e3:.0f} mm and {math.degrees(off[2]):.1f} deg "
            f"from the prediction, {math.sqrt(distance):.1f} sigmas"
        )


def surface_of(prior: Prior) -> Prior:
    """The height of the ground that a prediction says, and nothing else."""
    covariance = np.diag(np.full(6, _NOTHING_KNOWN**2))
    covariance[2, 2] = prior.covariance[2, 2]
    return Prior(prior.site_body, covariance)


def expect(
    chain: Chain, predicted: PoseEstimate, head_rad: Vec2, joints_rad: Vec2, tilt_rad: Vec2
) -> Expectation:
    """The expectation: place and heading as predicted, roll and pitch as the inclinometers say now."""
    roll, pitch = tilt_rad
    rotation = rot_z(predicted.heading_rad) @ rot_y(pitch) @ rot_x(roll)
    body = Transform(rotation, body_transform(predicted).position_m)
    P = np.array(predicted.covariance) + _FLOOR
    P[2, 2] += _TERRAIN_HEIGHT_SIGMA_M**2
    P[3, 3] += _TERRAIN_TILT_SIGMA_RAD**2
    P[4, 4] += _TERRAIN_TILT_SIGMA_RAD**2
    return Expectation(ChainState(body, head_rad, joints_rad), P)
