"""How many on/off pairs a localisation needs: the filter SNR predicted for range and angle of view."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Array
from perception.frames.psf import marker_spread
from perception.geometry.chain import Chain, ChainState

SNR_WANTED = 8.0
_PAIR_NOISE = math.sqrt(2.0)  # a difference of two frames


@dataclass(frozen=True)
class PlateView:
    """The view of the marker plane: range and cosine of the angle off its normal, worst of both cameras."""

    range_m: float
    cosine: float


def plate_view(chain: Chain, state: ChainState) -> PlateView:
    """How the cameras see the marker plane of a (predicted) state."""
    plc = chain.site_plc(state)
    head = chain.site_ih(state.head_rad)
    to_cameras = head.apply(chain.model.position_ih_m) - plc.apply(chain.markers_plc_m).mean(axis=0)
    ranges: Array = np.linalg.norm(to_cameras, axis=1)
    cosines = to_cameras @ plc.rotation[:, 2] / ranges
    return PlateView(float(ranges.max()), float(cosines.min()))


def emission(kind: str, cosine: float) -> float:
    """Intensity relative to face on (executive.core.rig.MarkerCalibration)."""
    return (1 + cosine) / 2 if kind == "dome" else max(cosine, 0.0)


def filter_snr_per_pair(rig: RigCalibration, view: PlateView) -> float:
    """Matched-filter SNR of one marker in a one-pair difference image (paper, section 4.2)."""
    reference = rig.sensor.snr_1_range_m
    flux_in_noise = (reference / view.range_m) ** 2 / marker_spread(rig, reference).peak
    spread = marker_spread(rig, view.range_m)
    return flux_in_noise * math.sqrt(spread.energy) * emission(rig.markers.emission, view.cosine)


def pairs_needed(snr_per_pair: float, wanted: float = SNR_WANTED) -> float:
    """Pairs that bring the stacked SNR to `wanted` (SNR grows with their square root); inf if never."""
    return math.inf if snr_per_pair <= 0 else max(1.0, math.ceil((wanted / snr_per_pair) ** 2 - 1e-9))


def flux_expected(rig: RigCalibration, view: PlateView) -> float:
    """Light of one marker summed over its image [counts]."""
    reference = rig.sensor.snr_1_range_m
    peak = _PAIR_NOISE * rig.sensor.noise_counts / marker_spread(rig, reference).peak
    return peak * (reference / view.range_m) ** 2 * emission(rig.markers.emission, view.cosine)
