"""Ground from a surveyed elevation model: GeoTIFF or .npy, with a window and a scale."""

from __future__ import annotations

import logging
import math
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tifffile

from executive.core.types import Array, Vec2
from sim_pybullet.procedural import fractal, levelled
from sim_pybullet.terrain import Terrain, TerrainError

MODEL_PIXEL_SCALE = "ModelPixelScaleTag"
NO_DATA = "GDAL_NODATA"
DEFAULT_LANDER_X_M = 2.0
UNREADABLE = (tifffile.TiffFileError, ValueError, TypeError, LookupError, OSError, struct.error)

logging.getLogger("tifffile").addHandler(logging.NullHandler())  # what it has to say comes as a TerrainError


@dataclass(frozen=True)
class Window:
    """A square part of the model: its lower left corner and width, in metres of the model (y up)."""

    x_m: float
    y_m: float
    width_m: float


@dataclass(frozen=True, eq=False)
class ElevationModel:
    """Heights [m], row 0 at the lower edge (y up), one sample each `cell_m`."""

    heights_m: Array
    cell_m: float

    @property
    def size_m(self) -> Vec2:
        """Extent along x and y between the first and the last sample."""
        rows, cols = self.heights_m.shape
        return (cols - 1) * self.cell_m, (rows - 1) * self.cell_m


def read_model(path: Path, cell_m: float | None = None) -> ElevationModel:
    """Read .tif (cell size from its ModelPixelScale tag) or .npy (`cell_m` needed). Image rows run downwards.

    TerrainError on a missing or unreadable file, non-square cells, holes, or an unknown cell size.
    """
    if not path.is_file():
        raise TerrainError(f"no such elevation model: {path}")
    if path.suffix.lower() == ".npy":
        heights, tagged = _read_npy(path), None
    elif path.suffix.lower() in (".tif", ".tiff"):
        heights, tagged = _read_tiff(path)
    else:
        raise TerrainError(f"{path}: got {path.suffix or 'no suffix'}, expected .tif, .tiff or .npy")
    cell = cell_m or tagged
    if cell is None:
        raise TerrainError(f"{path}: the file does not say its cell size; give `cell`")
    if heights.ndim != 2 or min(heights.shape) < 4:
        raise TerrainError(
            f"{path}: got an array of shape {heights.shape}, expected one band of 4 x 4 or more"
        )
    if not np.isfinite(heights).all():
        raise TerrainError(f"{path}: {int((~np.isfinite(heights)).sum())} cells hold no height")
    return ElevationModel(np.flipud(np.asarray(heights, dtype=np.float64)), float(cell))


def _read_npy(path: Path) -> Array:
    try:
        heights: Array = np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
    except (ValueError, TypeError, EOFError, OSError) as error:
        raise TerrainError(f"{path}: not a readable array of numbers: {error}") from error
    return heights


def _read_tiff(path: Path) -> tuple[Array, float | None]:
    try:
        with tifffile.TiffFile(path) as tiff:
            page = tiff.pages.first
            tag = page.tags.get(MODEL_PIXEL_SCALE)
            hole = page.tags.get(NO_DATA)
            heights = page.asarray().astype(np.float64)
            if hole is not None:
                heights[heights == float(hole.value)] = np.nan
            return heights, None if tag is None else _square_cell(path, tag.value)
    except UNREADABLE as error:
        raise TerrainError(f"{path}: not a readable TIFF: {error}") from error


def _square_cell(path: Path, scale: tuple[float, ...]) -> float:
    if not math.isclose(scale[0], scale[1], rel_tol=1e-6):
        raise TerrainError(f"{path}: got cells of {scale[0]} x {scale[1]} m, expected square ones")
    return float(scale[0])


def cut(
    model: ElevationModel,
    window: Window | None,
    lander_m: Vec2 | None,
    scale: float,
    cell_m: float,
) -> Terrain:
    """The window of the model as ground around the lander, bicubic, in cells of at most `cell_m`.

    `lander_m` is the lander's place from the window's lower left corner, in model metres; by default 2 m in,
    half way up. `scale` enlarges all three axes alike. TerrainError if the window leaves the model.
    """
    from scipy.interpolate import RectBivariateSpline  # a second, which a check of a scenario should not wait

    w = window_on(model, window)
    size = model.size_m
    lander = lander_m or default_lander_m(w)
    count = math.ceil(w.width_m * scale / cell_m) + 1
    step_m = w.width_m / (count - 1)
    axis = np.arange(count) * step_m
    rows, cols = model.heights_m.shape
    spline = RectBivariateSpline(
        np.arange(rows) * model.cell_m, np.arange(cols) * model.cell_m, model.heights_m, kx=3, ky=3, s=0
    )
    z = spline(np.minimum(w.y_m + axis, size[1]), np.minimum(w.x_m + axis, size[0]))
    origin = (-lander[0] * scale, -lander[1] * scale)
    return levelled(Terrain(np.ascontiguousarray(z) * scale, origin, step_m * scale))


def window_on(model: ElevationModel, window: Window | None) -> Window:
    """The window asked for, or the largest square; TerrainError if it leaves the model."""
    w = window or Window(0.0, 0.0, min(model.size_m))
    size = model.size_m
    slack = 1e-9 + model.cell_m  # a window of the whole width may count the last cell in full
    if w.x_m < 0 or w.y_m < 0 or w.x_m + w.width_m > size[0] + slack or w.y_m + w.width_m > size[1] + slack:
        raise TerrainError(
            f"the window x {w.x_m:.2f}..{w.x_m + w.width_m:.2f} m, y {w.y_m:.2f}..{w.y_m + w.width_m:.2f} m "
            f"leaves the elevation model of {size[0]:.2f} x {size[1]:.2f} m"
        )
    return w


def default_lander_m(window: Window) -> Vec2:
    """Where the lander stands unless told: 2 m in from the left, half way up [m from the lower left]."""
    return DEFAULT_LANDER_X_M, window.width_m / 2


def roughen(terrain: Terrain, roughness_m: float, rng: np.random.Generator) -> Terrain:
    """Add relief finer than the survey could see."""
    if roughness_m <= 0:
        return terrain
    rows, cols = terrain.elevation_m.shape
    fine = fractal(max(rows, cols), terrain.cell_m, rng)[:rows, :cols]
    return levelled(Terrain(terrain.elevation_m + roughness_m * fine, terrain.origin_site_m, terrain.cell_m))
