"""Maximum-likelihood pose on image intensities: the difference images of all markers, fitted by one pose.

No centres in between: where a single marker is too faint to be found, all of them together still have a
sharp likelihood. Each marker contributes a local fit of (flux, column, row) whose information goes through
the chain's Jacobian to pose, head and joints, next to encoders, inclinometers and the surface's height.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from perception.frames.difference import Difference
from perception.frames.psf import Spread
from perception.geometry.body import Transform
from perception.geometry.chain import STATE_SIZE, Chain, ChainState
from perception.geometry.pose import PoseReadings
from perception.kernels.climb import Place, Shown, Task, climbed, point_at
from perception.kernels.compiled import plain
from perception.kernels.linear import inverted

_PROBE_SIGMAS = 0.04


@dataclass(frozen=True, eq=False)
class MarkerPatches:
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
    ) -> MarkerPatches:
        pad = _radius(spread)
        left, right = (_padded(c.images, pad) for c in cameras)
        weights = [_padded(np.square(1 / c.sigma, dtype=np.float64), pad) for c in cameras]
        corners = [plain(corner) - pad for corner in corners_px]
        return cls((left, right), (weights[0], weights[1]), (corners[0], corners[1]), spread, plain(gain))

    def exchanged(self, order: Sequence[int]) -> MarkerPatches:
        """The same if each marker were on the line of the LED that stands in its place."""
        left, right = (images[order] for images in self.images)
        weights = [weights[order] for weights in self.weights]
        return replace(self, images=(left, right), weights=(weights[0], weights[1]))

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
    chain: Chain,
    patches: MarkerPatches,
    readings: PoseReadings,
    start: ChainState,
    flux_counts: Array,
    shared: bool,
) -> Likely | None:
    """Climb the likelihood from `start`; `shared` ties all markers to one flux. None if no light is found."""
    flux = plain(np.where(flux_counts > 0, flux_counts, 0.0))
    task = task_of(chain, patches, readings, flux, shared)
    place, at, steps, converged = climbed(task, place_of(start, flux))
    if not np.isfinite(at.value) or not place.flux_counts.any():
        return None
    pan, tilt, arm, cabin = place.angles_rad.tolist()
    state = ChainState(Transform(place.rotation, place.position_m), (pan, tilt), (arm, cabin))
    local = Local(at.local_information, at.local_score, at.local_gain)
    covariance, snr = inverted(at.information, 6), float(np.sqrt(max(at.value, 0.0)))
    return Likely(state, place.flux_counts, covariance, snr, local, at.readings_chi2, steps, converged)


def observed_information(
    chain: Chain, patches: MarkerPatches, readings: PoseReadings, at: Likely, shared: bool
) -> Array:
    """Information (10 + fluxes, square) from the likelihood's own curvature, by central differences.

    Of faint light each image has its luck; the curvature knows it, the expected information does not. That
    one is taken where the likelihood is not curved downwards in all directions.
    """
    task = task_of(chain, patches, readings, at.flux_counts, shared)

    def gradient(step: Array) -> Array:
        flux = at.flux_counts + task.groups @ step[STATE_SIZE:]
        return point_at(task, place_of(at.state.moved(step[:STATE_SIZE]), flux)).gradient

    expected = point_at(task, place_of(at.state, at.flux_counts)).information
    steps = np.diag(_PROBE_SIGMAS / np.sqrt(np.diag(expected)))
    H = np.stack([(gradient(-s) - gradient(s)) / (2 * s.max()) for s in steps])
    H = (H + H.T) / 2
    return H if np.linalg.eigvalsh(H)[0] > 0 else expected


def task_of(
    chain: Chain, patches: MarkerPatches, readings: PoseReadings, flux_counts: Array, shared: bool
) -> Task:
    """Everything that a state is held against; a marker without flux stays dark."""
    groups = plain(_groups(flux_counts, shared))
    return Task(*chain.kernel_rig, readings.measured, patches.shown, groups)


def place_of(state: ChainState, flux_counts: Array) -> Place:
    """A state with the markers' fluxes (n,) for the kernels."""
    body = state.site_body
    return Place(plain(body.rotation), plain(body.position_m), state.angles_rad, plain(flux_counts))


def _padded(images: NDArray[np.floating], pad: int) -> Array:
    """Images (n, h, w) with a rim of zeros."""
    n, height, width = images.shape
    padded = np.zeros((n, height + 2 * pad, width + 2 * pad))
    padded[:, pad:-pad, pad:-pad] = images
    return padded


def _radius(spread: Spread) -> int:
    return spread.radius_px + 1


def _groups(flux: Array, shared: bool) -> Array:
    """Which fluxes (n, groups) change together; a marker without flux has none."""
    own: Array = np.eye(len(flux))[:, np.flatnonzero(flux)]
    return own.sum(axis=1, keepdims=True) if shared else own
