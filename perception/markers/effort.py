"""How many pairs a localisation takes: enough to detect the rover, enough for the quality asked."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from executive.core.ports import LocaliseRequest
from executive.core.types import Array, Quality
from perception.frames.exposure import filter_snr_per_pair, pairs_needed, plate_view
from perception.geometry.chain import Chain
from perception.geometry.pose import PoseFit
from perception.geometry.prediction import Expectation
from perception.markers.fisher import centre_bounds, pose_bound

JOINT_SNR_WANTED = 9.5  # of all markers together: thresholds are 5 to 6.5, and an SNR scatters by 1
JOINT_ABOVE_PAIRS = 32  # where more would be needed to see each marker by itself, all are looked for as one
_STEP = 8  # pairs, to the next tried


@dataclass(frozen=True)
class Wanted:
    """The accuracy at which no more pairs are taken, and the pairs at which it is given up."""

    position_m: float
    heading_rad: float
    most_pairs: int

    def met_by(self, covariance: Array) -> bool:
        """Whether a pose covariance (6, 6) is good enough."""
        position = math.sqrt(max(float(np.linalg.eigvalsh(covariance[:2, :2])[-1]), 0.0))
        return position <= self.position_m and math.sqrt(max(covariance[5, 5], 0.0)) <= self.heading_rad


WANTED = {
    Quality.PRECISE: Wanted(0.030, math.radians(1.0), 320),
    Quality.FAR: Wanted(0.015, math.radians(0.5), 800),
}


def wanted_by(request: LocaliseRequest) -> Wanted:
    """What a request asks for: the accuracy of its quality, or its own where it says one."""
    usual = WANTED[request.quality]
    position_m = request.position_sigma_m or usual.position_m
    return replace(usual, position_m=position_m, heading_rad=request.heading_sigma_rad or usual.heading_rad)


def seen_singly(chain: Chain, expectation: Expectation) -> bool:
    """Whether each marker by itself is expected to stand out after few pairs."""
    snr = filter_snr_per_pair(chain.rig, plate_view(chain, expectation.state))
    return pairs_needed(snr) <= JOINT_ABOVE_PAIRS


def joint_pairs(chain: Chain, expectation: Expectation, wanted: Wanted) -> float:
    """Pairs for detection and for the accuracy wanted, by the Cramer-Rao bound; detection alone may ask for
    more than `most_pairs`, inf where no light is expected."""
    markers = len(chain.markers_plc_m)
    snr = filter_snr_per_pair(chain.rig, plate_view(chain, expectation.state)) * math.sqrt(2 * markers)
    pairs = pairs_needed(snr, JOINT_SNR_WANTED)
    if pairs >= wanted.most_pairs:
        return pairs
    one_pair = centre_bounds(chain, expectation.state, 1.0)
    height_m = math.sqrt(expectation.covariance[2, 2])
    for more in range(_rounded(pairs), wanted.most_pairs, _STEP):
        if wanted.met_by(pose_bound(chain, expectation.state, one_pair / more, height_sigma_m=height_m)):
            return more
    return wanted.most_pairs


def more_pairs(fit: PoseFit, pairs: int, wanted: Wanted) -> int:
    """Pairs to take after `pairs` gave this fit; 0 where it is good enough or they would be too many."""
    if wanted.met_by(fit.covariance):
        return 0
    position = math.sqrt(float(np.linalg.eigvalsh(fit.covariance[:2, :2])[-1]))
    excess = max(position / wanted.position_m, math.sqrt(fit.covariance[5, 5]) / wanted.heading_rad)
    more = min(math.ceil((excess**2 - 1) * pairs), wanted.most_pairs - pairs)
    return _rounded(more) if more >= _STEP else 0


def _rounded(pairs: float) -> int:
    return _STEP * max(1, math.ceil(pairs / _STEP))
