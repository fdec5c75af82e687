"""Where rays meet the ground: a vectorised march over the elevation grid."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from sim_pybullet.terrain import Terrain

_FARTHEST_M = 250.0
_MOST_STEPS = 400
_REFINEMENTS = 5


class HeightField:
    """An elevation grid prepared for ray tests. Beyond its edge the ground goes on level."""

    def __init__(self, terrain: Terrain) -> None:
        self._grid = np.ascontiguousarray(terrain.elevation_m, dtype=np.float32)
        self._x0, self._y0 = terrain.origin_site_m
        self.cell_m = terrain.cell_m
        slope_y, slope_x = np.gradient(self._grid, terrain.cell_m)
        # A step of height / (ray slope + this) cannot jump over the ground but on the steepest thousandth.
        self._steep = float(np.quantile(np.hypot(slope_x, slope_y), 0.999)) + 0.02
        self.top_m = float(self._grid.max())

    def height(self, x_m: NDArray[Any], y_m: NDArray[Any]) -> NDArray[np.float32]:
        """Bilinear elevation [m] of points of a 1-D or 2-D shape."""
        u = ((x_m - self._x0) / self.cell_m).astype(np.float32).reshape(1, -1)
        v = ((y_m - self._y0) / self.cell_m).astype(np.float32).reshape(1, -1)
        height = _remap_long(self._grid, u, v)
        return height.reshape(np.shape(x_m))

    def cast(self, start_m: Array, directions: Array) -> Array:
        """Depth along each ray (n, 3) from one start to the ground, in lengths of the ray; inf for sky."""
        dx, dy, dz = (np.asarray(directions[:, i], dtype=np.float32) for i in range(3))
        level = np.hypot(dx, dy) + np.float32(1e-9)
        found = np.full(len(dx), np.inf, dtype=np.float32)
        depth = np.zeros(len(dx), dtype=np.float32)
        before = depth.copy()
        live = np.arange(len(dx))
        for _ in range(_MOST_STEPS):
            gap = self._gap(start_m, dx[live], dy[live], dz[live], depth[live])
            hit = gap <= 0
            found[live[hit]] = depth[live[hit]]
            away = (depth[live] * level[live] > _FARTHEST_M) | (
                (dz[live] > 0) & (start_m[2] + depth[live] * dz[live] > self.top_m)
            )
            on = ~(hit | away)
            live, gap = live[on], gap[on]
            if not len(live):
                break
            before[live] = depth[live]
            reach = gap / (np.maximum(-dz[live], 0) + self._steep * level[live])
            least = np.maximum(0.4 * self.cell_m, 0.002 * depth[live] * level[live]) / (
                level[live] - dz[live]
            )
            depth[live] += np.maximum(reach, np.abs(least))
        return self._refined(start_m, directions, before, found)

    def blocks(self, start_m: Array, end_m: Array) -> bool:
        """Whether the ground rises above the straight line between two points."""
        line = end_m - start_m
        level = math.hypot(line[0], line[1])
        samples = np.linspace(0, 1, max(8, math.ceil(level / (0.5 * self.cell_m))), dtype=np.float32)
        along = start_m + samples[:, None] * line
        z = along[:, 2]
        return bool(np.any(self.height(along[:, 0], along[:, 1]) > z))

    def _gap(
        self,
        start_m: Array,
        dx: NDArray[np.float32],
        dy: NDArray[np.float32],
        dz: NDArray[np.float32],
        depth: NDArray[Any],
    ) -> NDArray[np.float32]:
        x, y, z = (np.float32(s) + depth * d for s, d in zip(start_m, (dx, dy, dz), strict=True))
        return np.asarray(z - self.height(x, y))

    def _refined(
        self, start_m: Array, directions: Array, before: NDArray[np.float32], found: NDArray[np.float32]
    ) -> Array:
        """Halve the bracket between the last step above the ground and the first below."""
        hit = np.isfinite(found)
        low, high = before[hit], found[hit]
        dx, dy, dz = (np.asarray(directions[hit, i], dtype=np.float32) for i in range(3))
        for _ in range(_REFINEMENTS):
            middle = (low + high) / 2
            under = self._gap(start_m, dx, dy, dz, middle) <= 0
            high = np.where(under, middle, high)
            low = np.where(under, low, middle)
        depth = found.astype(np.float64)
        depth[hit] = (low + high) / 2
        return depth


def _remap_long(
    grid: NDArray[np.float32], u: NDArray[np.float32], v: NDArray[np.float32]
) -> NDArray[np.float32]:
    """`cv2.remap` of one long row, folded because OpenCV bounds an image's width."""
    n, width = u.shape[1], 4096
    if n == 0:
        return np.empty(0, dtype=np.float32)
    rows = -(-n // width)
    fold = (
        [np.pad(a.ravel(), (0, rows * width - n)).reshape(rows, width) for a in (u, v)]
        if rows > 1
        else [u, v]
    )
    out = cv2.remap(grid, fold[0], fold[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(out, dtype=np.float32).ravel()[:n]
