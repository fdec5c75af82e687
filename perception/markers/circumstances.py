"""What candidates for markers are compared with: each other's brightness, and all readings besides images."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from executive.core.types import Vec2
from perception.geometry.chain import Chain
from perception.geometry.pose import Prior, Sighting
from perception.markers.centres import Detection

Candidates = Sequence[Sequence[Sequence[Detection]]]
"""[camera][marker] -> detections; [] for a blind camera."""


@dataclass(frozen=True, eq=False)
class Circumstances:
    """What is read besides images: encoders of head and cabin joints, inclinometers, the prediction."""

    chain: Chain
    head_rad: Vec2
    joints_rad: Vec2
    tilt_rad: Vec2 | None
    prior: Prior | None

    @property
    def markers(self) -> int:
        return len(self.chain.markers_plc_m)

    def sighting(self, detections: Iterable[tuple[int, int, Detection]]) -> Sighting:
        """The measurement that detections (camera, marker, detection) stand for."""
        uv, covariance = np.full((2, self.markers, 2), np.nan), np.full((2, self.markers, 2, 2), np.nan)
        for camera, marker, detection in detections:
            uv[camera, marker], covariance[camera, marker] = detection.uv_px, detection.covariance_px2
        return Sighting(uv, covariance, self.head_rad, self.joints_rad, self.tilt_rad)


def brightness_misfit(flux_counts: Sequence[float]) -> float:
    """Spread of the markers' brightness in squared factors of two: they share plane, range and power."""
    flux = np.array(flux_counts)
    return float(np.square(np.log2(flux / np.median(flux))).sum())
