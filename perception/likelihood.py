"""Maximum-likelihood pose on image intensities: the difference images of all markers, fitted by one pose.

No centres in between: where a single marker is too faint to be found, all of them together still have a
sharp likelihood. Each marker contributes a local fit of (flux, column, row) whose information goes through
the chain's Jacobian to pose, head and joints, next to encoders, inclinometers and the surface's height.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from executive.types import Array
from perception.chain import STATE_SIZE, Chain, ChainState
from perception.difference import Difference
from perception.kernels.compiled import plain
from perception.kernels.light import joined
from perception.kernels.light import local_fits as cameras_fits
from perception.pose import Readings
from perception.psf import Spread

_MAX_STEPS = 100
_MAX_STEP_PX = 0.7
_PROBE_SIGMAS = 0.04
_CONVERGED_GAIN = 1e-4  # of twice the log likelihood: a hundredth of a sigma


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the images say: difference images of both cameras, padded so that every patch lies inside.

    Per camera: images and inverse variances (n, h, w), zero in the padding, full-frame place of the first
    pixel. `gain` (2, n) is each marker's expected brightness relative to the others'.
    """

    images: tuple[Array, Array]
    weights: tuple[Array, Array]
    corners_px: tuple[Array, Array]
    spread: Spread
    gain: Array

    @classmethod
    def of(
        cls, cameras: Sequence[Difference], corners_px: Sequence[tuple[int, int]], spread: Spread, gain: Array
    ) -> Evidence:
        pad = patch_radius(spread)
        rim = ((0, 0), (pad, pad), (pad, pad))
        left, right = (np.pad(plain(c.images), rim) for c in cameras)
        weights = [np.pad(plain(c.sigma) ** -2, rim) for c in cameras]
        corners = [plain(corner) - pad for corner in corners_px]
        return cls((left, right), (weights[0], weights[1]), (corners[0], corners[1]), spread, plain(gain))


@dataclass(frozen=True, eq=False)
class Local:
    """Information (2, n, 3, 3), score (2, n, 3) of (flux, column, row), twice the gain in log likelihood."""

    information: Array
    score: Array
    gain: float


@dataclass(frozen=True, eq=False)
class Likely:
    """The most likely state near a start. `flux_counts` (n,) a marker; `snr` of all markers together.

    `covariance` (6, 6) of the body pose, by expected information; `local` is taken at the solution,
    `readings_chi2` from encoders, inclinometers and surface.
    """

    state: ChainState
    flux_counts: Array
    covariance: Array
    snr: float
    local: Local
    readings_chi2: float
    steps: int
    converged: bool


def most_likely(
    chain: Chain, evidence: Evidence, readings: Readings, start: ChainState, flux_counts: Array, shared: bool
) -> Likely | None:
    """Climb the likelihood from `start`; `shared` ties all markers to one flux. None if no light is found."""
    flux = np.where(flux_counts > 0, flux_counts, 0.0)
    groups = flux_groups(flux, shared)
    state = start
    at = _Point.of(chain, evidence, readings, state, flux, groups)
    damping, converged, count = 1e-2, False, 0
    for count in range(1, _MAX_STEPS + 1):  # noqa: B007 - reported
        whole = at.step(damping)
        gain_ahead = float(at.gradient @ whole)
        step = _limited(whole, at.by_state)
        moved = state.moved(step[:STATE_SIZE])
        lighter = flux + groups @ step[STATE_SIZE:]
        if (lighter < 0).any() or not lighter.any():
            lighter = np.maximum(lighter, 0.2 * flux)
        there = _Point.of(chain, evidence, readings, moved, lighter, groups)
        gained = there.value - at.value
        if gained > 0:
            state, flux, at = moved, lighter, there
        if gain_ahead < _CONVERGED_GAIN:
            converged = True
            break
        damping = damping / 4 if gained > 0.75 * gain_ahead else max(4 * damping, 0.1)
    if not np.isfinite(at.value) or not flux.any():
        return None
    covariance: Array = np.asarray(np.linalg.inv(at.information)[:6, :6], dtype=np.float64)
    snr = float(np.sqrt(max(at.value, 0.0)))
    return Likely(state, flux, covariance, snr, at.local, at.readings_chi2, count, converged)


def observed_information(
    chain: Chain, evidence: Evidence, readings: Readings, at: Likely, shared: bool
) -> Array:
    """Information (10 + fluxes, square) from the likelihood's own curvature, by central differences.

    Of faint light each image has its luck; the curvature knows it, the expected information does not. That
    one is taken where the likelihood is not curved downwards in all directions.
    """
    groups = flux_groups(at.flux_counts, shared)

    def gradient(step: Array) -> Array:
        flux = at.flux_counts + groups @ step[STATE_SIZE:]
        moved = at.state.moved(step[:STATE_SIZE])
        return _Point.of(chain, evidence, readings, moved, flux, groups).gradient

    expected = _Point.of(chain, evidence, readings, at.state, at.flux_counts, groups).information
    steps = np.diag(_PROBE_SIGMAS / np.sqrt(np.diag(expected)))
    H = np.stack([(gradient(-s) - gradient(s)) / (2 * s.max()) for s in steps])
    H = (H + H.T) / 2
    return H if np.linalg.eigvalsh(H)[0] > 0 else expected


@dataclass(frozen=True, eq=False)
class _Point:
    """The log likelihood at a state: twice its value, gradient and information over (state, fluxes)."""

    value: float
    gradient: Array
    information: Array
    by_state: Array
    local: Local
    readings_chi2: float

    @classmethod
    def of(
        cls,
        chain: Chain,
        evidence: Evidence,
        readings: Readings,
        state: ChainState,
        flux: Array,
        groups: Array,
    ) -> _Point:
        uv, J = chain.project(state)
        local = local_fits(evidence, uv, flux)
        light_by_flux = evidence.gain[..., None] * groups
        information, gradient = joined(J, light_by_flux, local.information, local.score)
        chi2 = readings.add_to(state, information[:STATE_SIZE, :STATE_SIZE], gradient[:STATE_SIZE])
        return cls(local.gain - chi2, gradient, information, J, local, chi2)

    def step(self, damping: float) -> Array:
        damped = self.information + damping * np.diag(np.diag(self.information) + 1e-12)
        return np.asarray(np.linalg.solve(damped, self.gradient), dtype=np.float64)


def local_fits(evidence: Evidence, uv_px: Array, flux: Array) -> Local:
    """Each marker's fit of (flux, column, row) at pixels (2, n, 2), fluxes (n,) [counts]."""
    spread, fits = evidence.spread, []
    for c, uv in enumerate(uv_px):
        light = flux * evidence.gain[c]
        seen = evidence.images[c], evidence.weights[c], evidence.corners_px[c]
        fits.append(cameras_fits(*seen, uv, light, spread.box_px, spread.sigma_px, patch_radius(spread)))
    information, score, gain = zip(*fits, strict=True)
    return Local(np.stack(information), np.stack(score), sum(gain))


def patch_radius(spread: Spread) -> int:
    """How far from a marker's middle its light is looked at [px]."""
    return spread.radius_px + 1


def flux_groups(flux: Array, shared: bool) -> Array:
    """Which fluxes (n, groups) change together; a marker without flux has none."""
    own: Array = np.eye(len(flux))[:, np.flatnonzero(flux)]
    return own.sum(axis=1, keepdims=True) if shared else own


def _limited(step: Array, by_state: Array) -> Array:
    """A step by which no marker moves farther than the spread's slope reaches."""
    farthest = float(np.linalg.norm(by_state @ step[:STATE_SIZE], axis=-1).max())
    return step * min(1.0, _MAX_STEP_PX / max(farthest, 1e-12))
