"""The ground as an elevation grid in `site`; everything that touches or sees it asks here."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import LongarmError
from executive.core.types import (
    Array,
    Segment,
    Vec2,
    Vec3,
)

CELL_M = 0.03
ROUTE_MARGIN_M = 0.5  # the rover and its noses stay on the ground even at the edge of the margin


class TerrainError(LongarmError):
    """The ground asked for cannot be made, or does not cover what is asked of it."""


@dataclass(frozen=True, eq=False)
class Terrain:
    """Elevation over a regular grid: `elevation_m[row, col]` at origin + (col, row) * cell.

    Rows run along y, columns along x; heights are relative to the site origin, where they are 0.
    """

    elevation_m: Array
    origin_site_m: Vec2
    cell_m: float

    def __post_init__(self) -> None:
        if self.elevation_m.ndim != 2 or min(self.elevation_m.shape) < 2:
            raise ValueError(
                f"got elevations of shape {self.elevation_m.shape}, expected two axes of 2 or more"
            )
        self.elevation_m.setflags(write=False)

    @property
    def corner_site_m(self) -> Vec2:
        """The corner opposite to the origin."""
        rows, cols = self.elevation_m.shape
        x0, y0 = self.origin_site_m
        return x0 + (cols - 1) * self.cell_m, y0 + (rows - 1) * self.cell_m

    def heights(self, x_m: Array, y_m: Array) -> Array:
        """Bilinear heights [m] at arrays of points of one shape; beyond the edge the edge goes on."""
        rows, cols = self.elevation_m.shape
        u = np.clip((np.asarray(x_m) - self.origin_site_m[0]) / self.cell_m, 0.0, cols - 1)
        v = np.clip((np.asarray(y_m) - self.origin_site_m[1]) / self.cell_m, 0.0, rows - 1)
        i: NDArray[np.intp] = np.minimum(u.astype(np.intp), cols - 2)
        j: NDArray[np.intp] = np.minimum(v.astype(np.intp), rows - 2)
        fu, fv = u - i, v - j
        z = self.elevation_m
        low = z[j, i] * (1 - fu) + z[j, i + 1] * fu
        high = z[j + 1, i] * (1 - fu) + z[j + 1, i + 1] * fu
        result: Array = low * (1 - fv) + high * fv
        return result

    def height(self, x_m: float, y_m: float) -> float:
        """Bilinear height at one point [m]."""
        return float(self.heights(np.array(x_m), np.array(y_m)))

    def normal(self, x_m: float, y_m: float, over_m: float | None = None) -> Vec3:
        """Upward unit normal from central differences over `over_m` (default: two cells)."""
        h = (over_m or 2 * self.cell_m) / 2
        z = self.heights(np.array([x_m + h, x_m - h, x_m, x_m]), np.array([y_m, y_m, y_m + h, y_m - h]))
        gx, gy = (z[0] - z[1]) / (2 * h), (z[2] - z[3]) / (2 * h)
        length = math.sqrt(gx * gx + gy * gy + 1.0)
        return float(-gx / length), float(-gy / length), 1.0 / length

    def crop(self, low_site_m: Vec2, high_site_m: Vec2) -> Terrain:
        """The part that covers this rectangle, on the same grid; clipped to what there is."""
        rows, cols = self.elevation_m.shape
        x0, y0 = self.origin_site_m
        i0 = max(0, math.floor((low_site_m[0] - x0) / self.cell_m))
        j0 = max(0, math.floor((low_site_m[1] - y0) / self.cell_m))
        i1 = min(cols - 1, math.ceil((high_site_m[0] - x0) / self.cell_m))
        j1 = min(rows - 1, math.ceil((high_site_m[1] - y0) / self.cell_m))
        part = self.elevation_m[j0 : j1 + 1, i0 : i1 + 1].copy()
        return Terrain(part, (x0 + i0 * self.cell_m, y0 + j0 * self.cell_m), self.cell_m)


@dataclass(frozen=True)
class Area:
    """A rectangle in `site`."""

    low_site_m: Vec2
    high_site_m: Vec2


def area_of(route: tuple[Segment, ...], margin_m: float) -> Area:
    """The rectangle around a route, with its off-track margins and `margin_m` more on each side."""
    if not route:
        raise ValueError("got an empty route, expected at least one segment")
    reach = [s.off_track_m + margin_m for s in route]
    ends = [(p, r) for s, r in zip(route, reach, strict=True) for p in (s.start, s.end)]
    low = (min(p.x_m - r for p, r in ends), min(p.y_m - r for p, r in ends))
    high = (max(p.x_m + r for p, r in ends), max(p.y_m + r for p, r in ends))
    return Area(low, high)


def points_outside(
    low: Vec2, high: Vec2, route: tuple[Segment, ...], margin_m: float
) -> Iterator[tuple[int, str]]:
    """The way-points that ground from `low` to `high` does not carry, each with the reason."""
    points = (route[0].start, *(segment.end for segment in route))
    for index, point in enumerate(points):
        reach_m = max(s.off_track_m for s in route[max(index - 1, 0) : index + 1]) + margin_m
        for axis, at, least, most in (("x", point.x_m, low[0], high[0]), ("y", point.y_m, low[1], high[1])):
            if least <= at - reach_m and at + reach_m <= most:
                continue
            near = f", with a margin of {reach_m:g} m," if least <= at <= most else ""
            window = f"the terrain window ({least:.4g} … {most:.4g} m)"
            yield index, f"{axis} {at:.4g} m{near} is outside {window}"


def require_cover(low: Vec2, high: Vec2, area: Area) -> None:
    """TerrainError that names the side where ground from `low` to `high` ends before the area does."""
    sides = (
        ("x", "below", low[0], area.low_site_m[0], area.low_site_m[0] < low[0]),
        ("y", "below", low[1], area.low_site_m[1], area.low_site_m[1] < low[1]),
        ("x", "above", high[0], area.high_site_m[0], area.high_site_m[0] > high[0]),
        ("y", "above", high[1], area.high_site_m[1], area.high_site_m[1] > high[1]),
    )
    short = [
        f"the route with its margins needs {axis} = {need:.2f} m, the ground has nothing {side} {end:.2f} m"
        for axis, side, end, need, missing in sides
        if missing
    ]
    if short:
        raise TerrainError("the terrain window does not cover the route: " + "; ".join(short))
