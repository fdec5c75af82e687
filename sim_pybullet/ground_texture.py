"""A procedural ground texture: layers of lit micro-relief and albedo, one per scale, seeded and endless.

Each layer is a tile that wraps, turned by an angle of its own so that no lattice shows. A layer fades where
the footprint of a pixel on the ground outgrows its structure, so far ground neither aliases nor shimmers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from sim_pybullet.sunlight import SKYLIGHT, Sun

Image = NDArray[np.float32]

_TILE = 512
_WAVELENGTH_TEXELS = 9.0  # the middle of the band that a tile holds
# (texel [m], relative contrast, bumps a tile): grains, pebbles, hand-sized relief, drifts
_LAYERS = (
    (0.0011, 0.060, 700),
    (0.0047, 0.085, 170),
    (0.021, 0.040, 0),
    (0.093, 0.045, 0),
)
_DARKEST, _BRIGHTEST = -0.6, 0.45  # no texel leaves this, however strong its bump


@dataclass(frozen=True, eq=False)
class _Layer:
    texel_m: float
    turn_rad: float
    tile: Image

    def sample(self, x_m: Image, y_m: Image) -> Image:
        c, s = math.cos(self.turn_rad) / self.texel_m, math.sin(self.turn_rad) / self.texel_m
        u = (np.float32(c) * x_m + np.float32(s) * y_m) % _TILE
        v = (np.float32(c) * y_m - np.float32(s) * x_m) % _TILE
        return np.asarray(cv2.remap(self.tile, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP))


class GroundTexture:
    """Relative radiance of the ground (mean 1) at any place, for one sun."""

    def __init__(self, sun: Sun, rng: np.random.Generator) -> None:
        self._layers = []
        for texel_m, contrast, bumps in _LAYERS:
            turn_rad = float(rng.uniform(0.1, 2 * math.pi))
            tile = _lit_tile(rng, math.tan(sun.height_rad), sun.azimuth_rad - turn_rad, bumps, contrast)
            self._layers.append(_Layer(texel_m, turn_rad, tile))

    def at(self, x_m: Image, y_m: Image, across_m: Image, along_m: Image) -> Image:
        """Texture at points (any 2-D shape) whose pixel footprint is `across_m` by `along_m`."""
        total = np.ones_like(x_m)
        nearest_m = float(across_m.min())
        for layer in self._layers:
            wavelength_m = layer.texel_m * _WAVELENGTH_TEXELS
            if nearest_m > 2 * wavelength_m:
                continue
            # A box of width F dims a wave by about exp(-(pi F / wavelength)^2 / 6); along the line of sight
            # the footprint spans several independent grains, whose mean falls with their square root.
            fade = np.exp(np.float32(-(math.pi**2) / 6 / wavelength_m**2) * across_m * across_m)
            fade /= np.sqrt(1 + along_m * np.float32(1 / wavelength_m))
            total += fade * layer.sample(x_m, y_m)
        return total


def _lit_tile(
    rng: np.random.Generator, tangent: float, azimuth_rad: float, bumps: int, contrast: float
) -> Image:
    """A tile of lit relief and albedo, zero mean, standard deviation `contrast`."""
    height = _band_noise(rng) * (0.25 if bumps else 0.5)
    _raise_bumps(height, bumps, rng)
    slope_y = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / 2
    slope_x = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / 2
    toward_sun = slope_x * math.cos(azimuth_rad) + slope_y * math.sin(azimuth_rad)
    facing = np.clip(1 - toward_sun / tangent, 0, 2.2) / np.sqrt(1 + slope_x**2 + slope_y**2)
    lit = SKYLIGHT + (1 - SKYLIGHT) * facing * _sunlit(height, tangent, azimuth_rad)
    tile = lit / lit.std() + 0.6 * _band_noise(rng)
    tile = (tile - tile.mean()) / tile.std() * contrast
    return np.asarray(np.clip(tile, _DARKEST, _BRIGHTEST), dtype=np.float32)


def _sunlit(height: Array, tangent: float, azimuth_rad: float) -> Array:
    """0 where the tile's own relief keeps the sun off, 1 elsewhere."""
    lit = np.ones_like(height)
    for step in range(1, 14):
        shift = (-round(step * math.sin(azimuth_rad)), -round(step * math.cos(azimuth_rad)))
        rise = np.roll(height, shift, (0, 1)) - height
        lit = np.minimum(lit, np.clip(0.5 + 2 * (step * tangent - rise), 0, 1))
    return np.asarray(lit)


def _band_noise(rng: np.random.Generator) -> Array:
    """Periodic noise of wavelengths around the tile's band, unit standard deviation."""
    frequency = np.fft.fftfreq(_TILE)
    radius = np.hypot(frequency[:, None], frequency[None, : _TILE // 2 + 1])
    band = np.exp(-((np.log(np.maximum(radius, 1e-9) * _WAVELENGTH_TEXELS)) ** 2) / (2 * 0.45**2))
    white = np.fft.rfft2(rng.standard_normal((_TILE, _TILE)))
    noise = np.fft.irfft2(white * band, s=(_TILE, _TILE))
    return np.asarray(noise / noise.std())


def _raise_bumps(height: Array, count: int, rng: np.random.Generator) -> None:
    """Put rounded pebbles on the relief, wrapping at the edges."""
    for _ in range(count):
        radius = min(1.6 + rng.exponential(1.3), 9.0)
        reach = math.ceil(radius)
        offset = np.arange(-reach, reach + 1)
        squeeze = rng.uniform(0.7, 1.3)
        dome = np.maximum(radius**2 - (offset[:, None] * squeeze) ** 2 - (offset[None, :] / squeeze) ** 2, 0)
        row, column = rng.integers(0, _TILE, 2)
        where = np.ix_((row + offset) % _TILE, (column + offset) % _TILE)
        height[where] = np.maximum(height[where], 0.8 * np.sqrt(dome))
