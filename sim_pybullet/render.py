"""The terrain layer of an image: lit, textured ground with rocks under a dusty sky, in electrons.

Rays of a coarse pixel grid are marched to the ground, their ground points interpolated to every pixel, and
texture and light looked up there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array, Window
from sim_pybullet.ground_texture import GroundTexture
from sim_pybullet.projection import PlacedCamera
from sim_pybullet.raycast import HeightField
from sim_pybullet.rocks_view import shade_by_rocks
from sim_pybullet.scene import Rock
from sim_pybullet.sunlight import Sun, ground_light
from sim_pybullet.terrain import Terrain

Image = NDArray[np.float32]

_COARSE_U, _COARSE_V = 4, 2  # px between marched rays
_SKY = 0.85  # radiance at the horizon relative to sunlit ground
_HAZE_M = 300.0  # range at which dust in the air has taken over
_ROW_SAMPLES_FROM_M = 6.0  # beyond, a pixel is long on the ground and is sampled twice a row


@dataclass(frozen=True, eq=False)
class GroundPoints:
    """Where the pixels of a window look: site coordinates (h, w), range and footprint [m], share of sky."""

    x_m: Image
    y_m: Image
    z_m: Image
    range_m: Image
    across_m: Image
    along_m: Image
    sky: Image


class TerrainRenderer:
    """Draws the world without the rover. Light and texture are prepared once per world."""

    def __init__(self, terrain: Terrain, sun: Sun, rng: np.random.Generator) -> None:
        self.field = HeightField(terrain)
        self._terrain = terrain
        self._texture = GroundTexture(sun, rng)
        self.shine(sun)
        self._origin, self._cell_m = terrain.origin_site_m, terrain.cell_m

    def shine(self, sun: Sun) -> None:
        """Move the sun: slopes and shadows follow it, the grain of the texture stays as it was lit first."""
        self.sun = sun
        self._light = ground_light(self._terrain, sun)

    def ground(self, view: PlacedCamera, window: Window, rocks: tuple[Rock, ...] = ()) -> tuple[Image, Image]:
        """Radiance (h, w) of ground and sky relative to sunlit level ground, and range (h, w) [m].

        The rocks' shadows are in it, the rocks themselves are not: `draw_rocks` paints them, near ones over
        whatever else stands on the ground.
        """
        samples = self._samples_a_row(view, window)
        points = self.ground_points(view, window, samples)
        image = self._texture.at(points.x_m, points.y_m, points.across_m, points.along_m)
        image *= self._light_at(points.x_m, points.y_m)
        shade_by_rocks(image, points.x_m, points.y_m, points.z_m, rocks, self.sun, view, window, samples)
        haze = 1 - np.exp(-points.range_m / np.float32(_HAZE_M))
        sky = np.repeat(_sky(view, window), samples, axis=0)
        image += np.maximum(points.sky, haze) * (sky - image)
        if samples > 1:
            image = image.reshape(window.height, samples, window.width).mean(axis=1)
        return image, points.range_m[::samples]

    def ground_points(self, view: PlacedCamera, window: Window, samples: int = 1) -> GroundPoints:
        """Ground points of the window's pixels, `samples` to a row."""
        u = _axis(window.u, window.width, _COARSE_U)
        v = _axis(window.v, window.height, _COARSE_V)
        directions = view.rays(*np.meshgrid(u, v)).reshape(-1, 3)
        depth = self.field.cast(view.position_site_m, directions)
        sky = ~np.isfinite(depth)
        depth = np.where(sky, 1e3, depth)
        coarse = view.position_site_m + depth[:, None] * directions
        shape = (len(v), len(u))
        rows = window.v + (np.arange(window.height * samples) + 0.5) / samples - 0.5
        columns = window.u + np.arange(window.width)
        map_u, map_v = np.meshgrid(
            ((columns - u[0]) / _COARSE_U).astype(np.float32), ((rows - v[0]) / _COARSE_V).astype(np.float32)
        )

        def fine(values: NDArray[Any]) -> Image:
            grid = np.asarray(values, dtype=np.float32).reshape(shape)
            return np.asarray(
                cv2.remap(grid, map_u, map_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            )

        range_m = fine(depth * np.linalg.norm(directions, axis=1))
        across_m = range_m / np.float32(view.camera.focal_px)
        grazing = fine(_grazing(directions))
        return GroundPoints(
            x_m=fine(coarse[:, 0]),
            y_m=fine(coarse[:, 1]),
            z_m=fine(coarse[:, 2]),
            range_m=range_m,
            across_m=across_m,
            along_m=across_m / np.float32(samples) / grazing,
            sky=fine(sky),
        )

    def _light_at(self, x_m: Image, y_m: Image) -> Image:
        u = (x_m - np.float32(self._origin[0])) / np.float32(self._cell_m)
        v = (y_m - np.float32(self._origin[1])) / np.float32(self._cell_m)
        return np.asarray(cv2.remap(self._light, u, v, cv2.INTER_LINEAR, borderValue=1.0))  # level beyond

    def _samples_a_row(self, view: PlacedCamera, window: Window) -> int:
        middle = view.rays(np.array([window.u + window.width / 2]), np.array([window.v + window.height / 2]))
        depth = float(self.field.cast(view.position_site_m, middle)[0])
        if not math.isfinite(depth):
            return 1
        return 2 if depth * float(np.linalg.norm(middle)) > _ROW_SAMPLES_FROM_M else 1


def _axis(first: int, size: int, step: int) -> Array:
    """Coarse pixel positions that cover `size` pixels from `first` with a margin.

    They fall on the same pixels of the frame whatever the window, so that windows agree where they overlap.
    """
    begin = (first - 1) // step
    end = (first + size + 1) // step + 1
    return step * np.arange(begin, end + 1, dtype=np.float64)


def _sky(view: PlacedCamera, window: Window) -> Image:
    """A dusty sky, brightest at the horizon, as a column (h, 1)."""
    rows = window.v + np.arange(window.height, dtype=np.float64)
    rays = view.rays(np.full(window.height, window.u + window.width / 2), rows)
    up = np.maximum(rays[:, 2] / np.linalg.norm(rays, axis=1), 0.0)
    return np.asarray(_SKY * (0.75 + 0.25 * np.exp(-up / 0.12)), dtype=np.float32)[:, None]


def _grazing(directions: Array) -> Array:
    """Sine of the angle between rays and level ground; slopes are left out of the footprint."""
    sine = np.abs(directions[:, 2]) / np.linalg.norm(directions, axis=1)
    return np.asarray(np.maximum(sine, 0.01))
