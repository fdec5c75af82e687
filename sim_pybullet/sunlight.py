"""The sun and what it does to the ground: shading by slope and cast shadows, as one map per world."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from sim_pybullet.terrain import Terrain

SKYLIGHT = 0.22  # share of the light on level ground that comes from the sky, not the sun
_LOWEST_RAD = math.radians(3.0)
_PENUMBRA = 0.012  # softness of shadows, as a difference of tangents: sun's disc and scattering


@dataclass(frozen=True)
class Sun:
    """Where the sun stands: elevation over the horizon and azimuth from site x, left positive [rad]."""

    elevation_rad: float = math.radians(35.0)
    azimuth_rad: float = math.radians(60.0)

    @property
    def height_rad(self) -> float:
        """Elevation, not below that of a sun so low that no exposure would be set for it."""
        return max(self.elevation_rad, _LOWEST_RAD)

    @property
    def direction_site(self) -> Array:
        """Unit vector towards the sun."""
        level = math.cos(self.height_rad)
        return np.array(
            [
                level * math.cos(self.azimuth_rad),
                level * math.sin(self.azimuth_rad),
                math.sin(self.height_rad),
            ]
        )

    def daylight(self, exposed_for: Sun) -> float:
        """Light on level ground over that under the sun for which the exposure was set."""
        direct = math.sin(self.height_rad) / math.sin(exposed_for.height_rad)
        return (1 - SKYLIGHT) * direct + SKYLIGHT

    def irradiance(self, normals: Array, lit: Array | NDArray[np.float32] | float = 1.0) -> Array:
        """Light on surfaces with these normals (..., 3), relative to sunlit level ground.

        `lit` is the visible share of the sun; the sky is taken as evenly bright over the upper half.
        """
        cosine = np.maximum(np.asarray(normals) @ self.direction_site, 0.0)
        sky = SKYLIGHT * (1 + np.asarray(normals)[..., 2]) / 2
        return np.asarray((1 - SKYLIGHT) * lit * cosine / math.sin(self.height_rad) + sky)


def ground_light(terrain: Terrain, sun: Sun) -> NDArray[np.float32]:
    """Irradiance of the bare ground on the elevation grid, relative to sunlit level ground."""
    slope_y, slope_x = np.gradient(terrain.elevation_m, terrain.cell_m)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return sun.irradiance(normals, sunlit_share(terrain, sun)).astype(np.float32)


def sunlit_share(terrain: Terrain, sun: Sun) -> NDArray[np.float32]:
    """0 in the ground's own cast shadow, 1 in the sun, by marching from every cell towards the sun."""
    height = np.asarray(terrain.elevation_m, dtype=np.float32)
    tangent = math.tan(sun.height_rad)
    farthest_m = float(np.ptp(height)) / tangent
    margin = np.full_like(height, np.inf)
    distance_m = terrain.cell_m
    while distance_m < farthest_m:
        shift = distance_m / terrain.cell_m
        move = np.array(
            [[1, 0, shift * math.cos(sun.azimuth_rad)], [0, 1, shift * math.sin(sun.azimuth_rad)]],
            dtype=np.float32,
        )
        ahead = cv2.warpAffine(
            height,
            move,
            (height.shape[1], height.shape[0]),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
            borderMode=cv2.BORDER_REPLICATE,
        )
        np.minimum(margin, np.float32(tangent) - (ahead - height) / np.float32(distance_m), out=margin)
        distance_m += max(terrain.cell_m, 0.04 * distance_m)
    return np.asarray(np.clip(0.5 + margin / (2 * _PENUMBRA), 0, 1), dtype=np.float32)
