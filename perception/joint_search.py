"""Where joint detection looks and what it climbs to: coarse search, then the most likely poses near by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from executive.types import Array, Vec2
from perception.chain import Chain, ChainState
from perception.chance_finds import joint_threshold
from perception.difference import Difference
from perception.exposure import emission, flux_expected, view_of
from perception.likelihood import Evidence, Likely, most_likely
from perception.markers import filter_snr
from perception.pose import Readings, Sighting
from perception.prediction import Expectation
from perception.psf import Spread
from perception.search import REGION_SIGMAS, FilterImages, Hypothesis, search

_STARTS = 12
_COARSE_LOSS = 3.0  # of joint SNR: more than the lattice can cost the best pose over another
_APART_PX = 1.0  # poses whose markers are farther apart than this are different explanations
_PLACE_AND_HEADING = 3  # directions of the region searched


@dataclass(frozen=True, eq=False)
class JointScene:
    """All that a search needs besides images; `seeing` lists the cameras that are not blind."""

    chain: Chain
    corners_px: Sequence[tuple[int, int]]
    spread: Spread
    expectation: Expectation
    readings: Readings
    widen: float
    seeing: Sequence[int]

    def evidence(self, images: Sequence[Difference]) -> Evidence:
        gain = relative_gain(self.chain, self.expectation.state)
        return Evidence.of(images, self.corners_px, self.spread, gain)

    def climbed(self, images: Sequence[Difference]) -> tuple[list[Likely], float]:
        """The distinct poses that the best places lead to, and the volume searched [m2 rad]."""
        filtered = [
            FilterImages(
                np.stack([filter_snr(i, s, self.spread) for i, s in zip(c.images, c.sigma, strict=True)]),
                corner,
            )
            for c, corner in zip(images, self.corners_px, strict=True)
        ]
        starts, volume = search(self.chain, filtered, self.expectation, self.spread, self.widen, _STARTS)
        unit = _flux_unit(images, self.spread)
        likely = _climb_all(self.chain, self.evidence(images), self.readings, starts, unit)
        return [one for one in likely if self.searched(one)], volume

    def searched(self, one: Likely) -> bool:
        """Whether a climb ended about where it was allowed to begin: of chance finds elsewhere the threshold
        knows nothing."""
        reach = REGION_SIGMAS * max(self.widen, 1.0)
        return self.expectation.distance2(one.state.site_body) <= _PLACE_AND_HEADING * reach**2

    def threshold(self, volume: float, rate: float) -> float:
        state = self.expectation.state
        return joint_threshold(self.chain, state, self.readings, self.spread, volume, rate, self.seeing)

    def expected_snr(self, images: Sequence[Difference]) -> float:
        """Joint SNR of all markers at their nominal power, seen as expected."""
        flux = flux_expected(self.chain.rig, view_of(self.chain, self.expectation.state))
        seen = len(self.seeing) * len(self.chain.markers_plc_m)
        return flux / _flux_unit(images, self.spread) * math.sqrt(seen)


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


def _climb_all(
    chain: Chain, evidence: Evidence, readings: Readings, starts: Sequence[Hypothesis], flux_unit: float
) -> list[Likely]:
    """The distinct poses that the starts lead to."""
    markers = len(chain.markers_plc_m)
    reached: list[Likely] = []
    for start in starts:
        if start.snr <= max(starts[0].snr - _COARSE_LOSS, 0.0):
            break
        flux = np.full(markers, start.snr / np.sqrt(2 * markers) * flux_unit)
        likely = most_likely(chain, evidence, readings, start.state, flux, shared=True)
        if likely is not None and not any(alike(chain, likely, other) for other in reached):
            reached.append(likely)
    return reached


def alike(chain: Chain, one: Likely, other: Likely) -> bool:
    apart = chain.project(one.state)[0] - chain.project(other.state)[0]
    return float(np.abs(apart).max()) < _APART_PX
