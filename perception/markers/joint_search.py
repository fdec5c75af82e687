"""Where joint detection looks and what it climbs to: coarse search, then the most likely poses near by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array, Vec2
from perception.frames.difference import Difference
from perception.frames.exposure import emission, flux_expected, plate_view
from perception.frames.psf import Spread
from perception.geometry.chain import Chain, ChainState
from perception.geometry.pose import PoseReadings, Sighting
from perception.geometry.prediction import Expectation
from perception.markers.centres import filter_snr
from perception.markers.false_alarms import joint_threshold
from perception.markers.likelihood import Likely, MarkerPatches, most_likely
from perception.markers.search import REGION_SIGMAS, FilterImages, Lattice

_STARTS = 12
_COARSE_LOSS = 3.0  # of joint SNR: more than the lattice can cost the best pose over another
_APART_PX = 1.0  # poses whose markers are farther apart than this are different explanations
_PLACE_AND_HEADING = 3  # directions of the region searched


@dataclass(frozen=True, eq=False)
class Searchable:
    """Difference images made ready: matched-filter SNR, patches, and the flux [counts] of a marker whose
    filter SNR is 1."""

    filtered: tuple[FilterImages, FilterImages]
    patches: MarkerPatches
    flux_unit: float

    def exchanged(self, order: Sequence[int]) -> Searchable:
        """The same if each marker were on the line of the LED that stands in its place."""
        left, right = (replace(one, snr=one.snr[order]) for one in self.filtered)
        return replace(self, filtered=(left, right), patches=self.patches.exchanged(order))


@dataclass(frozen=True, eq=False)
class JointScene:
    """All that a search needs besides images; `seeing` lists the cameras that are not blind."""

    chain: Chain
    corners_px: Sequence[tuple[int, int]]
    spread: Spread
    expectation: Expectation
    readings: PoseReadings
    widen: float
    seeing: Sequence[int]

    @cached_property
    def _lattice(self) -> Lattice:
        return Lattice.of(self.chain, self.expectation, self.spread, self.widen)

    @property
    def volume(self) -> float:
        """Of place and heading, searched [m2 rad]."""
        return self._lattice.volume

    def prepared(self, images: Sequence[Difference]) -> Searchable:
        """Difference images of both cameras, filtered once for all searches."""
        left, right = (
            FilterImages(
                np.stack([filter_snr(i, s, self.spread) for i, s in zip(c.images, c.sigma, strict=True)]),
                corner,
            )
            for c, corner in zip(images, self.corners_px, strict=True)
        )
        gain = relative_gain(self.chain, self.expectation.state)
        patches = MarkerPatches.of(images, self.corners_px, self.spread, gain)
        return Searchable((left, right), patches, _flux_unit(images, self.spread))

    def climbed(self, images: Searchable, used: NDArray[np.bool_] | None = None) -> list[Likely]:
        """The distinct poses that the best places lead to by the light of all markers, or the used (n,)."""
        used = np.ones(len(self.chain.markers_plc_m), dtype=np.bool_) if used is None else used
        starts = self._lattice.best(images.filtered, used, _STARTS)
        reached: list[Likely] = []
        for start in starts:
            if start.snr <= max(starts[0].snr - _COARSE_LOSS, 0.0):
                break
            flux = used * (start.snr / np.sqrt(2 * len(used)) * images.flux_unit)
            one = most_likely(self.chain, images.patches, self.readings, start.state, flux, shared=True)
            if one is not None and not any(alike(self.chain, one, other) for other in reached):
                reached.append(one)
        return [one for one in reached if self.searched(one)]

    def searched(self, one: Likely) -> bool:
        """Whether a climb ended about where it was allowed to begin: of false alarms elsewhere the threshold
        knows nothing."""
        reach = REGION_SIGMAS * max(self.widen, 1.0)
        return self.expectation.distance2(one.state.site_body) <= _PLACE_AND_HEADING * reach**2

    def threshold(self, rate: float) -> float:
        """The joint SNR that noise alone exceeds somewhere in the region at this rate."""
        state = self.expectation.state
        return joint_threshold(self.chain, state, self.readings, self.spread, self.volume, rate, self.seeing)

    def expected_snr(self, images: Searchable) -> float:
        """Joint SNR of all markers at their nominal power, seen as expected."""
        flux = flux_expected(self.chain.rig, plate_view(self.chain, self.expectation.state))
        seen = len(self.seeing) * len(self.chain.markers_plc_m)
        return flux / images.flux_unit * math.sqrt(seen)


def relative_gain(chain: Chain, state: ChainState) -> Array:
    """Brightness (2, n) expected of each marker relative to their mean: nearer ones and those faced shine."""
    plc = chain.site_plc(state)
    cameras = chain.site_ih(state.head_rad).apply(chain.model.position_ih_m)
    to_camera = cameras[:, None] - chain.markers_site(state)[None]
    ranges = np.linalg.norm(to_camera, axis=-1)
    cosines = to_camera @ plc.rotation[:, 2] / ranges
    facing = np.array([[emission(chain.rig.markers.emission, float(c)) for c in row] for row in cosines])
    power = np.maximum(facing, 1e-3) / ranges**2
    gain: Array = power / power.mean()
    return gain


def sighting_without_centres(chain: Chain, expectation: Expectation, tilt_rad: Vec2) -> Sighting:
    """The readings that go with the images; the centres stay open."""
    n = len(chain.markers_plc_m)
    state = expectation.state
    unseen = np.full((2, n, 2), np.nan)
    return Sighting(unseen, np.full((2, n, 2, 2), np.nan), state.head_rad, state.joints_rad, tilt_rad)


def _flux_unit(cameras: Sequence[Difference], spread: Spread) -> float:
    """Flux [counts] of a marker whose filter SNR is 1."""
    every = np.array([float(np.median(s)) for c in cameras for s in c.sigma])
    sigma = np.median(every[np.isfinite(every)]) if np.isfinite(every).any() else 1.0
    return float(sigma / np.sqrt(spread.energy))


def alike(chain: Chain, one: Likely, other: Likely) -> bool:
    apart = chain.project(one.state)[0] - chain.project(other.state)[0]
    return float(np.abs(apart).max()) < _APART_PX
