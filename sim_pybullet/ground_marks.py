"""What the cheap tier has in place of the ground's texture: points of it that can be found again."""

from __future__ import annotations

import numpy as np

from executive.core.types import Array, Landmarks, Window
from sim_pybullet.projection import PlacedCamera
from sim_pybullet.raycast import HeightField

SPACING_M, REACH_M, NEAREST_M = 0.15, 5.0, 0.8
SIGMA_PX = 0.017
"""How far the full tier's registration of a patch is off, root mean square an axis; see
`benchmarks/head_watch.py`."""
ROVER_REACH_M = 0.25


class GroundMarks:
    """A lattice of points on the ground around the lander, under names drawn at random."""

    def __init__(self, field: HeightField, rng: np.random.Generator) -> None:
        self._rng = rng
        axis = np.arange(-REACH_M, REACH_M + SPACING_M / 2, SPACING_M)
        x_m, y_m = (grid.ravel() for grid in np.meshgrid(axis, axis))
        near = (np.hypot(x_m, y_m) < REACH_M) & (np.hypot(x_m, y_m) > NEAREST_M)
        x_m, y_m = x_m[near], y_m[near]
        self._points_site_m: Array = np.stack([x_m, y_m, field.height(x_m, y_m)], axis=1).astype(np.float64)
        self._names = rng.permutation(len(x_m))

    def seen(self, view: PlacedCamera, window: Window, rover_site_m: Array) -> Landmarks:
        """Those that a camera shows in its window and the rover at (3,) does not hide, with noise."""
        uv_px, depth_m = view.project(self._points_site_m)
        rover_px, rover_depth_m = view.project(rover_site_m)
        low, size = (window.u, window.v), (window.width, window.height)
        with np.errstate(invalid="ignore"):
            inside = ((uv_px >= low) & (uv_px <= np.add(low, size) - 1)).all(axis=1)
            reach_px = view.camera.focal_px * ROVER_REACH_M / max(float(rover_depth_m), ROVER_REACH_M)
            hidden = (np.linalg.norm(uv_px - rover_px, axis=1) < reach_px) & (depth_m > rover_depth_m - 0.5)
        shown = inside & ~hidden
        noise_px = SIGMA_PX * self._rng.standard_normal(uv_px.shape)  # for all, whatever is seen
        return Landmarks(self._names[shown], uv_px[shown] + noise_px[shown])


def nothing_seen() -> Landmarks:
    """A picture in which no ground can be told apart."""
    return Landmarks(np.empty(0, dtype=np.int64), np.empty((0, 2)))
