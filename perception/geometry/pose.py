"""Stereo pose of the rover: linear first guess (paper, eqs. 3-5), then Gauss-Newton (eqs. 6-11).

The iteration runs over the body's pose in `site` with rotation-vector increments (no singular attitude,
unlike the ZXZ angles of eq. 8), weighted by the centres' covariances. Encoder readings of head and cabin
joints, inclinometers and, on request, the prediction enter as further measurements.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2 as chi2_distribution

from executive.core.types import Array, Vec2
from perception.geometry.body import Transform
from perception.geometry.chain import STATE_SIZE, Chain, ChainState
from perception.geometry.checks import as_array, as_finite
from perception.kernels.compiled import plain
from perception.kernels.first_guess import body_guess, plane_guess
from perception.kernels.gauss_newton import PoseProblem, gauss_newton, weights_of
from perception.kernels.readings import WeightedReadings, add_readings
from perception.kernels.readings import roll_pitch as attitude

_SIGMA_TILT_FLOOR_RAD = 1e-7
_NO_PRIOR = np.eye(3), np.zeros(3), np.zeros((6, 6))


@dataclass(frozen=True, eq=False)
class Sighting:
    """What a pose is estimated from.

    `uv_px` (2, n, 2), NaN where a marker was not seen; `covariance_px2` (2, n, 2, 2); encoder readings of
    the head (pan, tilt) and the cabin joints (arm, cabin); inclinometers (roll, pitch) or None [rad].
    """

    uv_px: Array
    covariance_px2: Array
    head_rad: Vec2
    joints_rad: Vec2
    tilt_rad: Vec2 | None = None

    @property
    def angles_rad(self) -> Array:
        """Encoder readings of pan, tilt, arm, cabin (4,)."""
        return np.array([*self.head_rad, *self.joints_rad])


@dataclass(frozen=True, eq=False)
class Prior:
    """A predicted body pose in site with its covariance (6, 6), used as a measurement."""

    site_body: Transform
    covariance: Array

    @property
    def weighted(self) -> tuple[Array, Array, Array]:
        """Rotation, position and inverse covariance."""
        weight = plain(np.linalg.inv(self.covariance))
        return plain(self.site_body.rotation), plain(self.site_body.position_m), weight


@dataclass(frozen=True, eq=False)
class PoseFit:
    """An estimated state. `covariance` (6, 6) of the body pose; `chi2` of the residuals with `dof`.

    `residual_px` (2, n, 2) is measured minus reprojected, NaN where not seen.
    """

    state: ChainState
    covariance: Array
    chi2: float
    dof: int
    reprojected_px: Array
    residual_px: Array
    steps: int
    converged: bool

    def consistent(self, probability: float = 0.999) -> bool:
        """Whether the residuals are as small as noise makes them with this probability."""
        return self.converged and self.chi2 <= chi2_limit(self.dof, probability)


def chi2_limit(dof: int, probability: float) -> float:
    """Chi-square quantile."""
    return float(chi2_distribution.ppf(probability, max(dof, 1)))


def linear_guess(points_m: Array, markers_plc_m: Array) -> Transform:
    """Pose of `plc` in the frame of measured marker positions (n >= 3, 3), by eqs. 3-5.

    Needs markers in the plane z = 0, not on one line; ValueError otherwise. Exact without noise.
    """
    points, markers = _on_plane(points_m, markers_plc_m)
    return _spanned(len(points), *plane_guess(points, markers))


def guess_body(chain: Chain, points_ih_m: Array, sighting: Sighting, markers: list[int]) -> Transform:
    """First guess of the body in site from triangulated `markers` (3 or more), points (n, 3) in ih."""
    points, chosen = _on_plane(points_ih_m, chain.markers_plc_m[markers])
    _, head, cabin, _ = chain.kernel_rig
    return _spanned(len(points), *body_guess(head, cabin, points, chosen, sighting.angles_rad))


def _on_plane(points_m: Array, markers_plc_m: Array) -> tuple[Array, Array]:
    """Points and markers (n, 3) each for the kernels; ValueError unless finite, as many, and z = 0."""
    points = plain(as_finite("points_m", points_m, (None, 3)))
    markers = plain(as_finite("markers_plc_m", markers_plc_m, (len(points), 3)))
    if np.abs(markers[:, 2]).max() > 1e-9:
        raise ValueError("markers_plc_m: got z other than 0, expected markers in the plane z = 0")
    return points, markers


def _spanned(count: int, rotation: Array, position_m: Array, spanned: bool) -> Transform:
    if not spanned:
        raise ValueError(f"got {count} markers on one line, expected 3 or more that span a plane")
    return Transform(rotation, position_m)


def estimate(chain: Chain, sighting: Sighting, start: Transform, prior: Prior | None = None) -> PoseFit:
    """Weighted least squares over the chain from `start`; ValueError on wrong shapes or too few marks."""
    shape = (2, len(chain.markers_plc_m), 2)
    uv = plain(as_array("uv_px", sighting.uv_px, shape))
    weights, seen = weights_of(uv, plain(as_array("covariance_px2", sighting.covariance_px2, (*shape, 2))))
    readings = PoseReadings.of(chain, sighting, prior)
    dof = 2 * seen + readings.extra_rows - 6
    if dof < 0:
        raise ValueError(f"got {seen} marker images, expected enough to fix 6 degrees of freedom")
    problem = PoseProblem(*chain.kernel_rig, readings.measured, uv, weights)
    found = gauss_newton(problem, plain(start.rotation), plain(start.position_m), sighting.angles_rad)
    pan, tilt, arm, cabin = found.angles_rad.tolist()
    state = ChainState(Transform(found.rotation, found.position_m), (pan, tilt), (arm, cabin))
    return PoseFit(
        state,
        found.covariance,
        found.chi2,
        dof,
        found.reprojected_px,
        found.residual_px,
        found.steps,
        found.converged,
    )


@dataclass(frozen=True, eq=False)
class PoseReadings:
    """Everything measured besides pixels: encoders, inclinometers, the prediction.

    `extra_rows` is how many numbers that is, beyond the encoders' four.
    """

    measured: WeightedReadings
    extra_rows: int

    @classmethod
    def of(cls, chain: Chain, sighting: Sighting, prior: Prior | None) -> PoseReadings:
        sigma_tilt = max(chain.rig.rover.inclinometer_sigma_rad, _SIGMA_TILT_FLOOR_RAD)
        tilted = sighting.tilt_rad is not None
        measured = WeightedReadings(
            sighting.angles_rad,
            chain.encoder_weight,
            np.array(sighting.tilt_rad or (0.0, 0.0)),
            sigma_tilt**-2 if tilted else 0.0,
            *(_NO_PRIOR if prior is None else prior.weighted),
        )
        return cls(measured, 2 * tilted + (0 if prior is None else 6))

    def add_to(self, state: ChainState, H: Array, g: Array) -> float:
        """Add these measurements to the normal equations (10, 10), (10,) in place; returns their share of
        chi-square."""
        body = state.site_body
        share, pull = np.zeros((STATE_SIZE, STATE_SIZE)), np.zeros(STATE_SIZE)
        place = plain(body.rotation), plain(body.position_m), state.angles_rad
        chi2 = add_readings(self.measured, *place, share, pull)
        H += share
        g += pull
        return chi2


def roll_pitch(rotation: Array) -> tuple[Array, Array]:
    """Inclinometer readings (roll, pitch) [rad] of a body attitude Rz(yaw) Ry(pitch) Rx(roll), with their
    derivative (2, 3) by a small rotation vector in site."""
    roll, pitch, by_turn = attitude(plain(rotation))
    return np.array([roll, pitch]), by_turn
