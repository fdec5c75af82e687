"""The point spread a marker is expected to show: LED square (x) Gaussian (x) defocus, over pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Array
from perception.kernels.compiled import plain
from perception.kernels.light import profiles


@dataclass(frozen=True)
class Spread:
    """A square of side `box_px` blurred by a Gaussian of `sigma_px`; separable in u and v."""

    box_px: float
    sigma_px: float

    @property
    def radius_px(self) -> int:
        """Half-width of a patch that holds all but some 1e-4 of the light."""
        return math.ceil(self.box_px / 2 + 4 * self.sigma_px)

    def profile(self, offset_px: Array) -> Array:
        """Share of the light in a pixel whose centre lies `offset_px` from the marker, in one axis."""
        return self._profiles(offset_px)[0]

    def profile_slope(self, offset_px: Array) -> Array:
        """d profile / d offset [1/px]."""
        return self._profiles(offset_px)[1]

    def _profiles(self, offset_px: Array) -> tuple[Array, Array]:
        shares, slopes = profiles(plain(offset_px).ravel(), self.box_px, self.sigma_px)
        return shares.reshape(offset_px.shape), slopes.reshape(offset_px.shape)

    def line(self) -> Array:
        """Shares in one axis of a marker centred on a pixel, shape (2 r + 1,)."""
        return self.profile(np.arange(-self.radius_px, self.radius_px + 1.0))

    def kernel(self) -> Array:
        """Shares of a marker centred on a pixel, shape (2 r + 1, 2 r + 1)."""
        return np.outer(self.line(), self.line())

    @property
    def width_px(self) -> float:
        """Standard deviation of the light along one axis, pixels included."""
        return math.sqrt(self.sigma_px**2 + (self.box_px**2 + 1) / 12)

    @property
    def peak(self) -> float:
        """Share of the light in the brightest pixel, the marker centred on it."""
        return float(self.profile(np.zeros(1))[0] ** 2)

    @property
    def energy(self) -> float:
        """Sum of squared shares: a matched filter turns flux F into an SNR of F sqrt(energy) / noise."""
        return float((self.kernel() ** 2).sum())


def marker_spread(rig: RigCalibration, range_m: float) -> Spread:
    """What one LED looks like at `range_m`; ValueError unless the range is positive and finite."""
    if not (math.isfinite(range_m) and range_m > 0):
        raise ValueError(f"range_m: got {range_m}, expected a positive length")
    sensor = rig.sensor
    defocus_diameter = sensor.defocus_px_m * abs(1 / range_m - 1 / sensor.focus_m)
    focal_px = sum(c.focal_px for c in rig.cameras) / len(rig.cameras)
    return Spread(
        box_px=max(focal_px * rig.markers.size_m / range_m, 1e-3),
        sigma_px=math.hypot(sensor.psf_sigma_px, defocus_diameter / 4),
    )
