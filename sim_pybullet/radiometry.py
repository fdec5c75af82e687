"""Linear radiometry in electrons: the sensor's constants, a marker's power, its point spread.

Everything upstream of the noise is an expectation in electrons a pixel and exposure. The exposure is set
so that sunlit level ground of mean albedo fills `GROUND_FRACTION` of the well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from executive.core.rig import RigCalibration, SensorCalibration
from executive.core.types import Array

FULL_WELL_E = 160_000.0
GROUND_FRACTION = 0.40
READ_NOISE_E = 40.0
_SPREAD_SIGMAS = 4.5


@dataclass(frozen=True)
class Exposure:
    """Electrons of the sensor [e-] and counts: full scale is the full well."""

    bits: int
    full_well_e: float = FULL_WELL_E
    ground_e: float = FULL_WELL_E * GROUND_FRACTION
    read_noise_e: float = READ_NOISE_E

    @property
    def max_count(self) -> int:
        return int(2**self.bits - 1)

    @property
    def gain_e(self) -> float:
        """Electrons a count."""
        return self.full_well_e / self.max_count

    @property
    def full(self) -> bool:
        """Whether the ground alone fills the well."""
        return self.ground_e >= self.full_well_e

    def under(self, light: float) -> Exposure:
        """The same exposure with the ground brighter or darker than it was set for."""
        return replace(self, ground_e=self.ground_e * light)

    @property
    def noise_counts(self) -> float:
        """Standard deviation of one pixel of sunlit level ground: shot, read and quantisation noise."""
        variance_e2 = self.ground_e + self.read_noise_e**2
        return math.sqrt(variance_e2 / self.gain_e**2 + 1 / 12)


@dataclass(frozen=True)
class MarkerLight:
    """A marker's light: `electrons_m2` = e- a exposure, summed over the image, at 1 m and face on [e- m2]."""

    electrons_m2: float

    def electrons(self, range_m: float, emission: float, brightness: float = 1.0) -> float:
        """Total signal of one marker in one image [e-]."""
        return self.electrons_m2 * emission * brightness / range_m**2


def calibrated_light(rig: RigCalibration) -> MarkerLight:
    """Marker power at which the single-pixel difference SNR is 1 at `snr_1_range_m` (paper, section 4.2).

    Solved for a marker facing the camera and centred on a pixel: its brightest pixel in a difference of
    two frames then equals the standard deviation of that difference over sunlit ground.
    """
    exposure = Exposure(rig.sensor.bits)
    range_m = rig.sensor.snr_1_range_m
    difference_noise_e = math.sqrt(2.0) * exposure.noise_counts * exposure.gain_e
    size_px = rig.cameras[0].focal_px * rig.markers.size_m / range_m
    _, _, spread = pixel_spread(0.0, 0.0, size_px, spread_sigma_px(rig.sensor, range_m))
    return MarkerLight(difference_noise_e / float(spread.max()) * range_m**2)


def emission_factor(kind: str, cosine: float) -> float:
    """Intensity relative to face on, for the cosine of the angle between normal and line of sight."""
    if kind == "dome":
        return (1 + cosine) / 2
    return max(cosine, 0.0)


def spread_sigma_px(sensor: SensorCalibration, range_m: float) -> float:
    """Gaussian width of the point spread at a range: optics and defocus.

    The disc of confusion of diameter D is taken as the Gaussian of its variance along a line: sigma = D / 4.
    """
    disc_px = sensor.defocus_px_m * abs(1 / range_m - 1 / sensor.focus_m)
    return math.hypot(sensor.psf_sigma_px, disc_px / 4)


def pixel_spread(u_px: float, v_px: float, size_px: float, sigma_px: float) -> tuple[int, int, Array]:
    """A square of `size_px` at (u, v), blurred by a Gaussian and integrated over pixels; sums to 1.

    Returns the column and row of the patch's first pixel and the patch (rows, columns).
    """
    reach = spread_reach_px(size_px, sigma_px)
    columns = math.floor(u_px) + np.arange(-reach, reach + 2)
    rows = math.floor(v_px) + np.arange(-reach, reach + 2)
    patch = np.outer(
        line_spread(rows - v_px, size_px, sigma_px), line_spread(columns - u_px, size_px, sigma_px)
    )
    return int(columns[0]), int(rows[0]), patch


def spread_reach_px(size_px: float, sigma_px: float) -> int:
    """Pixels from a marker's middle beyond which no light to speak of falls."""
    return math.ceil(size_px / 2 + _SPREAD_SIGMAS * sigma_px + 0.5)


def line_spread(offset_px: NDArray[Any], size_px: float, sigma_px: float) -> Array:
    """Share of a blurred line segment that falls into the pixels at these offsets from its middle."""

    def integrated_edge(x: NDArray[Any]) -> Array:
        t = x / sigma_px
        return np.asarray(x * ndtr(t) + sigma_px * np.exp(-0.5 * t * t) / math.sqrt(2 * math.pi))

    far, near = (size_px + 1) / 2, (size_px - 1) / 2
    share = (
        integrated_edge(offset_px + far)
        - integrated_edge(offset_px + near)
        - integrated_edge(offset_px - near)
        + integrated_edge(offset_px - far)
    )
    return np.asarray(share / size_px)
