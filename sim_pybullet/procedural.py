"""Ground made from numbers: fractional Brownian relief, craters, a slope."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.types import Array, Vec2
from sim_pybullet.terrain import Terrain

HURST = 0.8  # natural soil surfaces lie at 0.7 to 0.9
LONGEST_M = 2.0  # relief longer than this would be a slope, which has its own setting
RIM_TO_DEPTH = 0.2
CRATER_DIAMETERS_M = (0.4, 1.6)
DEPTH_TO_DIAMETER = 0.06  # old, degraded craters; a fresh one has 0.2


@dataclass(frozen=True)
class Relief:
    """What the ground is made of. `roughness_m` is the RMS height of relief of up to 2 m wavelength."""

    roughness_m: float = 0.008
    craters: int = 0
    slope_rad: float = 0.0
    slope_azimuth_rad: float = 0.0  # direction in which the ground rises, from site x, left positive


def make_ground(
    relief: Relief, low_m: Vec2, width_m: float, cell_m: float, rng: np.random.Generator
) -> Terrain:
    """A square of ground `width_m` wide whose lower left corner is `low_m`; 0 at the site origin."""
    count = math.ceil(width_m / cell_m) + 1
    axis = np.arange(count) * cell_m
    x, y = np.meshgrid(low_m[0] + axis, low_m[1] + axis)
    z = (
        relief.roughness_m * fractal(count, cell_m, rng)
        if relief.roughness_m > 0
        else np.zeros((count, count))
    )
    for _ in range(relief.craters):
        centre = rng.uniform(low_m, np.add(low_m, width_m))
        z = z + crater(x - centre[0], y - centre[1], float(rng.uniform(*CRATER_DIAMETERS_M)))
    rise = math.tan(relief.slope_rad)
    z = z + rise * (x * math.cos(relief.slope_azimuth_rad) + y * math.sin(relief.slope_azimuth_rad))
    return levelled(Terrain(z, low_m, cell_m))


def fractal(count: int, cell_m: float, rng: np.random.Generator) -> Array:
    """Fractional Brownian relief of RMS 1, shape (count, count): spectral density k^-(2H+2) below 2 m."""
    padded = 1 << (count - 1).bit_length()  # made larger and cut, so that opposite edges do not match
    k = (
        2
        * math.pi
        * np.hypot(np.fft.fftfreq(padded, cell_m)[:, None], np.fft.rfftfreq(padded, cell_m)[None, :])
    )
    shortest = 2 * math.pi / LONGEST_M
    amplitude = np.where(k >= shortest, np.maximum(k, shortest) ** -(HURST + 1.0), 0.0)
    white = np.fft.rfft2(rng.standard_normal((padded, padded)))
    relief: Array = np.fft.irfft2(white * amplitude, s=(padded, padded))[:count, :count]
    return relief / float(relief.std())


def crater(dx_m: Array, dy_m: Array, diameter_m: float) -> Array:
    """A parabolic bowl with a rim that fades outward within one radius [m]."""
    depth_m = DEPTH_TO_DIAMETER * diameter_m
    r = np.hypot(dx_m, dy_m) / (diameter_m / 2)
    rim = RIM_TO_DEPTH * depth_m
    bowl = (depth_m + rim) * r**2 - depth_m
    apron = rim * np.exp(-3.0 * (np.maximum(r, 1.0) - 1.0))
    return np.where(r < 1.0, bowl, np.where(r < 3.0, apron, 0.0))


def levelled(terrain: Terrain) -> Terrain:
    """The same ground, shifted so that the site origin has height 0."""
    return Terrain(terrain.elevation_m - terrain.height(0.0, 0.0), terrain.origin_site_m, terrain.cell_m)
