"""Maximum-likelihood pose on image intensities: the difference images of all markers, fitted by one pose.

No centres in between: where a single marker is too faint to be found, all of them together still have a
sharp likelihood. Each marker contributes a local fit of (flux, column, row) whose information goes through
the chain's Jacobian to pose, head and joints, next to encoders, inclinometers and the surface's height.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from executive.types import Array
from perception.body import Transform
from perception.chain import STATE_SIZE, Chain, ChainState
from perception.difference import Difference
from perception.kernels.climb import Place, Shown, Task, climbed, point_at
from perception.kernels.compiled import plain
from perception.kernels.linear import inverted
from perception.pose import Readings
from perception.psf import Spread

_PROBE_SIGMAS = 0.04


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
        left, right = (np.pad(plain(c.images), rim) for c in cameras)
        weights = [np.pad(plain(c.sigma) ** -2, rim) for c in cameras]
        corners = [plain(corner) - pad for corner in corners_px]
        return cls((left, right), (weights[0], weights[1]), (corners[0], corners[1]), spread, plain(gain))

    @cached_property
    def shown(self) -> Shown:
        """The same for the kernels."""
        box_px, sigma_px = self.spread.box_px, self.spread.sigma_px
        corners = np.stack(self.corners_px)
        return Shown(self.images, self.weights, corners, self.gain, box_px, sigma_px, _radius(self.spread))


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
    flux = plain(np.where(flux_counts > 0, flux_counts, 0.0))
    task = _task(chain, evidence, readings, _groups(flux, shared))
    place, at, steps, converged = climbed(task, _place(start, flux))
    if not np.isfinite(at.value) or not place.flux_counts.any():
        return None
    pan, tilt, arm, cabin = place.angles_rad.tolist()
    state = ChainState(Transform(place.rotation, place.position_m), (pan, tilt), (arm, cabin))
    local = Local(at.local_information, at.local_score, at.local_gain)
    covariance, snr = inverted(at.information, 6), float(np.sqrt(max(at.value, 0.0)))
    return Likely(state, place.flux_counts, covariance, snr, local, at.readings_chi2, steps, converged)


def observed_covariance(
    chain: Chain, evidence: Evidence, readings: Readings, at: Likely, shared: bool
) -> Array:
    """Covariance (6, 6) of the body pose from the likelihood's own curvature, by central differences.

    Of faint light each image has its luck; the curvature knows it, the expected information does not. That
    one is taken where the likelihood is not curved downwards in all directions.
    """
    groups = _groups(at.flux_counts, shared)
    task = _task(chain, evidence, readings, groups)

    def gradient(step: Array) -> Array:
        flux = at.flux_counts + groups @ step[STATE_SIZE:]
        return point_at(task, _place(at.state.moved(step[:STATE_SIZE]), flux)).gradient

    expected = point_at(task, _place(at.state, at.flux_counts)).information
    steps = np.diag(_PROBE_SIGMAS / np.sqrt(np.diag(expected)))
    H = np.stack([(gradient(-s) - gradient(s)) / (2 * s.max()) for s in steps])
    H = (H + H.T) / 2
    curved = bool(np.linalg.eigvalsh(H)[0] > 0)
    information = _with_tails(H if curved else expected, readings, at)
    covariance: Array = np.asarray(np.linalg.inv(information)[:6, :6], dtype=np.float64)
    return (covariance + covariance.T) / 2


def _with_tails(information: Array, readings: Readings, at: Likely) -> Array:
    """The information (n, n) whose inverse is the covariance of a likelihood with the tails that light has.

    Twice the log likelihood falls off as snr^2 exp(-q), q quadratic in the d directions that the images
    determine, not as snr^2 (1 - q). To first order in 1 / snr^2 the covariance of such a peak is that of its
    curvature times 1 + (d + 2) / snr^2.
    """
    read = np.zeros_like(information)
    readings.add_to(at.state, read[:STATE_SIZE, :STATE_SIZE], np.zeros(STATE_SIZE))
    images = information - read
    fluxes = len(information) - STATE_SIZE
    directions = float(np.trace(np.linalg.solve(information, images))) - fluxes
    return np.asarray(read + images / (1 + (directions + 2) / at.snr**2), dtype=np.float64)


def _task(chain: Chain, evidence: Evidence, readings: Readings, groups: Array) -> Task:
    return Task(*chain.kernel_rig, readings.measured, evidence.shown, plain(groups))


def _place(state: ChainState, flux_counts: Array) -> Place:
    body = state.site_body
    return Place(plain(body.rotation), plain(body.position_m), state.angles_rad, plain(flux_counts))


def _radius(spread: Spread) -> int:
    return spread.radius_px + 1


def _groups(flux: Array, shared: bool) -> Array:
    """Which fluxes (n, groups) change together; a marker without flux has none."""
    own: Array = np.eye(len(flux))[:, np.flatnonzero(flux)]
    return own.sum(axis=1, keepdims=True) if shared else own
