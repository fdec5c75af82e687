"""Maximum-likelihood pose on image intensities: the difference images of all markers, fitted by one pose.

No centres in between: where a single marker is too faint to be found, all of them together still have a
sharp likelihood. Each marker contributes a local fit of (flux, column, row) whose information goes through
the chain's Jacobian to pose, head and joints, next to encoders, inclinometers and the surface's height.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.types import Array
from perception.chain import STATE_SIZE, Chain, ChainState
from perception.difference import Difference
from perception.pose import Readings
from perception.psf import Spread

_MAX_STEPS = 40
_MAX_STEP_PX = 0.7
_CONVERGED_PX = 1e-3
_CONVERGED_FLUX = 1e-3


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
        pad = _radius(spread)
        rim = ((0, 0), (pad, pad), (pad, pad))
        left, right = (np.pad(c.images.astype(np.float64), rim) for c in cameras)
        weights = [np.pad(1.0 / c.sigma.astype(np.float64) ** 2, rim) for c in cameras]
        corners = [np.array(corner) - pad for corner in corners_px]
        return cls((left, right), (weights[0], weights[1]), (corners[0], corners[1]), spread, gain)


@dataclass(frozen=True, eq=False)
class Local:
    """Information (2, n, 3, 3), score (2, n, 3) of (flux, column, row), twice the gain in log likelihood."""

    information: Array
    score: Array
    gain: float


@dataclass(frozen=True, eq=False)
class Likely:
    """The most likely state near a start. `flux_counts` (n,) a marker; `snr` of all markers together.

    `covariance` (6, 6) of the body pose; `local` is taken at the solution, `readings_chi2` from encoders,
    inclinometers and surface.
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
    groups = _groups(flux, shared)
    state = start
    at = _Point.of(chain, evidence, readings, state, flux, groups)
    damping, converged, count = 1e-3, False, 0
    for count in range(1, _MAX_STEPS + 1):  # noqa: B007 - reported
        step = _limited(at.step(damping), at.by_state)
        moved = state.moved(step[:STATE_SIZE])
        lighter = flux + groups @ step[STATE_SIZE:]
        if (lighter < 0).any() or not lighter.any():
            lighter = np.maximum(lighter, 0.2 * flux)
        there = _Point.of(chain, evidence, readings, moved, lighter, groups)
        if there.value >= at.value - 1e-9 * (1 + abs(at.value)):
            state, flux, at = moved, lighter, there
            damping = max(damping / 10, 1e-9)
            if _small(step, at.by_state, groups @ step[STATE_SIZE:], flux):
                converged = True
                break
        elif (damping := damping * 10) > 1e6:
            converged = True
            break
    if not np.isfinite(at.value) or not flux.any():
        return None
    H = np.linalg.inv(at.information)[:6, :6]
    snr = float(np.sqrt(max(at.value, 0.0)))
    return Likely(state, flux, (H + H.T) / 2, snr, at.local, at.readings_chi2, count, converged)


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
        size = STATE_SIZE + groups.shape[1]
        G = np.zeros((*uv.shape[:2], 3, size))
        G[..., 0, STATE_SIZE:] = evidence.gain[..., None] * groups
        G[..., 1:, :STATE_SIZE] = J
        information = np.einsum("cnik,cnij,cnjl->kl", G, local.information, G, optimize=True)
        gradient = np.einsum("cnik,cni->k", G, local.score)
        H, g = np.zeros((STATE_SIZE, STATE_SIZE)), np.zeros(STATE_SIZE)
        chi2 = readings.add_to(state, H, g)
        information[:STATE_SIZE, :STATE_SIZE] += H
        gradient[:STATE_SIZE] += g
        return cls(local.gain - chi2, gradient, information, J, local, chi2)

    def step(self, damping: float) -> Array:
        damped = self.information + damping * np.diag(np.diag(self.information) + 1e-12)
        return np.asarray(np.linalg.solve(damped, self.gradient), dtype=np.float64)


def local_fits(evidence: Evidence, uv_px: Array, flux: Array) -> Local:
    """Each marker's fit of (flux, column, row) at pixels (2, n, 2), fluxes (n,) [counts]."""
    radius, spread = _radius(evidence.spread), evidence.spread
    offsets = np.arange(-radius, radius + 1)
    information, score = np.zeros((2, len(flux), 3, 3)), np.zeros((2, len(flux), 3))
    total = 0.0
    for c in (0, 1):
        middle = np.rint(np.nan_to_num(uv_px[c], nan=-1e6)).astype(int)
        patch, weight = _patches(evidence, c, middle, offsets)
        du, dv = (offsets + (middle[:, i] - uv_px[c, :, i])[:, None] for i in (0, 1))
        pu, pv, su, sv = (
            spread.profile(du),
            spread.profile(dv),
            spread.profile_slope(du),
            spread.profile_slope(dv),
        )
        light = (flux * evidence.gain[c])[:, None, None]
        shape = pv[:, :, None] * pu[:, None, :]
        T = np.stack(
            [shape, -light * pv[:, :, None] * su[:, None, :], -light * sv[:, :, None] * pu[:, None, :]], 1
        )
        rest = patch - light * shape
        information[c] = np.einsum("nihw,njhw,nhw->nij", T, T, weight, optimize=True)
        score[c] = np.einsum("nihw,nhw->ni", T, rest * weight)
        total += float((weight * (patch**2 - rest**2)).sum())
    return Local(information, score, total)


def _patches(
    evidence: Evidence, camera: int, middle: NDArray[np.int_], offsets: NDArray[np.int_]
) -> tuple[Array, Array]:
    """Images and weights (n, k, k) around whole pixels (n, 2); patches off the window weigh nothing."""
    images, weights = evidence.images[camera], evidence.weights[camera]
    place = middle - evidence.corners_px[camera]
    size = np.array(images.shape[:0:-1])
    inside = ((place >= len(offsets) // 2) & (place < size - len(offsets) // 2)).all(axis=1)
    place = np.where(inside[:, None], place, len(offsets) // 2)
    index = (
        np.arange(len(middle))[:, None, None],
        (place[:, 1, None] + offsets)[:, :, None],
        (place[:, 0, None] + offsets)[:, None, :],
    )
    return images[index], weights[index] * inside[:, None, None]


def _radius(spread: Spread) -> int:
    return spread.radius_px + 1


def _groups(flux: Array, shared: bool) -> Array:
    """Which fluxes (n, groups) change together; a marker without flux has none."""
    alive = np.flatnonzero(flux)
    if shared:
        return np.isin(np.arange(len(flux)), alive).astype(np.float64)[:, None]
    groups: Array = np.eye(len(flux))[:, alive]
    return groups


def _limited(step: Array, by_state: Array) -> Array:
    """A step by which no marker moves farther than the spread's slope reaches."""
    farthest = float(np.linalg.norm(by_state @ step[:STATE_SIZE], axis=-1).max())
    return step * min(1.0, _MAX_STEP_PX / max(farthest, 1e-12))


def _small(step: Array, by_state: Array, flux_step: Array, flux: Array) -> bool:
    farthest = float(np.abs(by_state @ step[:STATE_SIZE]).max())
    return farthest < _CONVERGED_PX and bool((np.abs(flux_step) <= _CONVERGED_FLUX * flux.max()).all())
