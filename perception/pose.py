"""Stereo pose of the rover: linear first guess (paper, eqs. 3-5), then Gauss-Newton (eqs. 6-11).

The iteration runs over the body's pose in `site` with rotation-vector increments (no singular attitude,
unlike the ZXZ angles of eq. 8), weighted by the centres' covariances. Encoder readings of head and cabin
joints, inclinometers and, on request, the prediction enter as further measurements.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2 as chi2_distribution

from executive.types import Array, Vec2
from perception.body import Transform, body_from_plc
from perception.chain import STATE_SIZE, Chain, ChainState
from perception.checks import as_array, as_finite
from perception.rotation import log_map, nearest_rotation

_MAX_STEPS = 20
_CONVERGED = 1e-7  # m and rad
_MAX_TURN_RAD = 0.5  # longest rotation of one step


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


@dataclass(frozen=True, eq=False)
class Prior:
    """A predicted body pose in site with its covariance (6, 6), used as a measurement."""

    site_body: Transform
    covariance: Array


@dataclass(frozen=True, eq=False)
class Fix:
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
    Y = as_finite("points_m", points_m, (None, 3)).T
    X = as_finite("markers_plc_m", markers_plc_m, (Y.shape[1], 3)).T
    if np.abs(X[2]).max() > 1e-9:
        raise ValueError("markers_plc_m: got z other than 0, expected markers in the plane z = 0")
    X_cut = np.vstack([X[:2], np.ones(X.shape[1])])
    if np.linalg.matrix_rank(X_cut, tol=1e-6) < 3:
        raise ValueError(f"got {X.shape[1]} markers on one line, expected 3 or more that span a plane")
    A = Y @ X_cut.T @ np.linalg.inv(X_cut @ X_cut.T)
    columns = np.column_stack([A[:, 0], A[:, 1], np.cross(A[:, 0], A[:, 1])])
    centroid = X_cut.mean(axis=1)
    rotation = nearest_rotation(columns)
    return Transform(rotation, A @ centroid - rotation[:, :2] @ centroid[:2])


def guess_body(chain: Chain, points_ih_m: Array, sighting: Sighting, markers: list[int]) -> Transform:
    """First guess of the body in site from triangulated `markers` (3 or more), points (n, 3) in ih."""
    ih_plc = linear_guess(points_ih_m, chain.markers_plc_m[markers])
    site_plc = chain.site_ih(sighting.head_rad) @ ih_plc
    body, _ = body_from_plc(chain.rig.cabin, site_plc, np.zeros((6, 6)), *sighting.joints_rad)
    return body


def estimate(chain: Chain, sighting: Sighting, start: Transform, prior: Prior | None = None) -> Fix:
    """Weighted least squares over the chain from `start`; ValueError on wrong shapes or too few marks."""
    weights, seen = _whitening(chain, sighting)
    readings = Readings.of(chain, sighting, prior)
    dof = 2 * int(seen.sum()) + readings.extra_rows - 6
    if dof < 0:
        raise ValueError(f"got {int(seen.sum())} marker images, expected enough to fix 6 degrees of freedom")
    state = ChainState(start, sighting.head_rad, sighting.joints_rad)
    H, g, cost = _normal_equations(chain, state, sighting, weights, seen, readings)
    converged, step_count = False, 0
    for step_count in range(1, _MAX_STEPS + 1):  # noqa: B007 - reported
        step = _limited(np.asarray(np.linalg.solve(H, g), dtype=np.float64))
        moved = state.moved(step)
        H_new, g_new, cost_new = _normal_equations(chain, moved, sighting, weights, seen, readings)
        while not cost_new <= cost + 1e-9 * (1 + cost) and np.abs(step).max() > _CONVERGED:
            step = step / 4
            moved = state.moved(step)
            H_new, g_new, cost_new = _normal_equations(chain, moved, sighting, weights, seen, readings)
        state, H, g, cost = moved, H_new, g_new, cost_new
        if np.abs(step).max() < _CONVERGED:
            converged = bool(np.isfinite(cost))
            break
    uv, _ = chain.project(state)
    covariance = np.linalg.inv(H)[:6, :6] if np.isfinite(H).all() else np.full((6, 6), np.nan)
    residual = np.where(seen[..., None], sighting.uv_px - uv, np.nan)
    covariance = (covariance + covariance.T) / 2
    return Fix(state, covariance, float(cost), dof, uv, residual, step_count, converged)


def _whitening(chain: Chain, sighting: Sighting) -> tuple[Array, NDArray[np.bool_]]:
    """Inverse centre covariances (2, n, 2, 2), zero where not seen, and the mask of what was seen (2, n)."""
    n = len(chain.markers_plc_m)
    uv = as_array("uv_px", sighting.uv_px, (2, n, 2))
    covariance = as_array("covariance_px2", sighting.covariance_px2, (2, n, 2, 2))
    seen = np.asarray(np.isfinite(uv).all(axis=-1) & np.isfinite(covariance).all(axis=(-1, -2)))
    safe = np.where(seen[..., None, None], covariance, np.eye(2))
    weights: Array = np.asarray(np.linalg.inv(safe), dtype=np.float64) * seen[..., None, None]
    return weights, seen


@dataclass(frozen=True, eq=False)
class Readings:
    """Everything measured besides pixels: encoders, inclinometers, the prediction."""

    encoder: Array
    encoder_weight: Array
    tilt: Array | None
    tilt_weight: float
    prior: Prior | None
    prior_weight: Array | None

    @classmethod
    def of(cls, chain: Chain, sighting: Sighting, prior: Prior | None) -> Readings:
        sigma_tilt = chain.rig.rover.inclinometer_sigma_rad
        return cls(
            encoder=np.array([*sighting.head_rad, *sighting.joints_rad]),
            encoder_weight=chain.encoder_sigma_rad() ** -2,
            tilt=None if sighting.tilt_rad is None else np.array(sighting.tilt_rad),
            tilt_weight=max(sigma_tilt, 1e-7) ** -2,
            prior=prior,
            prior_weight=None
            if prior is None
            else np.asarray(np.linalg.inv(prior.covariance), dtype=np.float64),
        )

    @property
    def extra_rows(self) -> int:
        return (0 if self.tilt is None else 2) + (0 if self.prior is None else 6)

    def add_to(self, state: ChainState, H: Array, g: Array) -> float:
        """Add these measurements to the normal equations in place; returns their share of chi-square."""
        off = self.encoder - [*state.head_rad, *state.joints_rad]
        H[range(6, STATE_SIZE), range(6, STATE_SIZE)] += self.encoder_weight
        g[6:] += self.encoder_weight * off
        cost = float(self.encoder_weight @ off**2)
        R = state.site_body.rotation
        if self.tilt is not None:
            angles, J = roll_pitch(R)
            off = self.tilt - angles
            H[3:6, 3:6] += self.tilt_weight * J.T @ J
            g[3:6] += self.tilt_weight * J.T @ off
            cost += float(self.tilt_weight * off @ off)
        if self.prior is not None and self.prior_weight is not None:
            turn = log_map(self.prior.site_body.rotation @ R.T)
            off = np.concatenate([self.prior.site_body.position_m - state.site_body.position_m, turn])
            H[:6, :6] += self.prior_weight
            g[:6] += self.prior_weight @ off
            cost += float(off @ self.prior_weight @ off)
        return cost


def _normal_equations(
    chain: Chain,
    state: ChainState,
    sighting: Sighting,
    weights: Array,
    seen: NDArray[np.bool_],
    readings: Readings,
) -> tuple[Array, Array, float]:
    """Information matrix, right-hand side and chi-square at a state (eqs. 10, 11)."""
    uv, J = chain.project(state)
    off = np.where(seen[..., None], sighting.uv_px - uv, 0.0).reshape(-1, 2, 1)
    J = np.where(seen[..., None, None], J, 0.0).reshape(-1, 2, STATE_SIZE)
    W = weights.reshape(-1, 2, 2)
    WJ = (W @ J).reshape(-1, STATE_SIZE)
    H = J.reshape(-1, STATE_SIZE).T @ WJ
    g = WJ.T @ off.reshape(-1)
    cost = float((off * (W @ off)).sum())
    return H, g, cost + readings.add_to(state, H, g)


def _limited(step: Array) -> Array:
    """A step that turns the body by at most `_MAX_TURN_RAD`, for starts far away."""
    turn = float(np.linalg.norm(step[3:6]))
    return step if turn <= _MAX_TURN_RAD else step * (_MAX_TURN_RAD / turn)


def roll_pitch(rotation: Array) -> tuple[Array, Array]:
    """Inclinometer readings (roll, pitch) [rad] of a body attitude Rz(yaw) Ry(pitch) Rx(roll), with their
    derivative (2, 3) by a small rotation vector in site."""
    down = rotation[2]
    angles = np.array([math.atan2(down[1], down[2]), -math.asin(float(np.clip(down[0], -1, 1)))])
    by_turn = np.stack([rotation[1], -rotation[0], np.zeros(3)], axis=1)  # d down / d turn, (3, 3)
    level = max(float(down[1] ** 2 + down[2] ** 2), 1e-12)
    by_down = np.array([[0.0, down[2] / level, -down[1] / level], [-1 / math.sqrt(level), 0.0, 0.0]])
    return angles, by_down @ by_turn
