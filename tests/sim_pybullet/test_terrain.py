"""Ground: heights, normals, cover, procedural relief, and windows of elevation models."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import tifffile

from executive.core.chance import generator
from sim_pybullet.config import TerrainConfig
from sim_pybullet.elevation_model import Window, cut, read_model
from sim_pybullet.procedural import Relief, make_ground
from sim_pybullet.site import make_terrain
from sim_pybullet.terrain import Terrain, TerrainError
from tests.sim_pybullet.worlds import AHEAD, route

REAL_MODEL = Path(__file__).parents[3] / "shared" / "reference" / "dem" / "marsyard2021.tif"


def tilted(rise_x: float = 0.1, rise_y: float = -0.05) -> Terrain:
    x, y = np.meshgrid(np.arange(41) * 0.1 - 1.0, np.arange(31) * 0.1 - 1.5)
    return Terrain(rise_x * x + rise_y * y, (-1.0, -1.5), 0.1)


def write_tiff(path: Path, heights_m: np.ndarray, cell_m: float, hole: str | None = None) -> Path:
    tags = [(33550, "d", 3, (cell_m, cell_m, 0.0), True)]
    if hole is not None:
        tags.append((42113, "s", 0, hole, True))
    tifffile.imwrite(path, heights_m.astype(np.float32), extratags=tags)
    return path


def test_heights_of_a_plane_are_exact_between_the_grid_points() -> None:
    terrain = tilted()
    assert terrain.height(0.537, -0.211) == pytest.approx(0.0537 + 0.01055, abs=1e-12)


def test_heights_beyond_the_edge_continue_the_edge() -> None:
    terrain = tilted()
    assert terrain.height(99.0, 0.0) == pytest.approx(terrain.height(3.0, 0.0))


def test_normal_of_a_plane_leans_downhill() -> None:
    normal = tilted(0.1, -0.05).normal(0.5, 0.2)
    assert normal == pytest.approx(np.array([-0.1, 0.05, 1.0]) / math.sqrt(1 + 0.01 + 0.0025))


def test_crop_keeps_heights_and_covers_what_was_asked() -> None:
    terrain = make_ground(Relief(), (-1.0, -1.0), 3.0, 0.03, np.random.default_rng(1))
    part = terrain.crop((0.2, 0.3), (0.9, 1.1))
    assert part.origin_site_m[0] <= 0.2
    assert part.corner_site_m[1] >= 1.1
    assert part.height(0.555, 0.777) == pytest.approx(terrain.height(0.555, 0.777), abs=1e-12)


def test_roughness_is_the_rms_height_of_the_relief() -> None:
    terrain = make_ground(Relief(roughness_m=0.008), (-3.0, -3.0), 12.0, 0.03, np.random.default_rng(3))
    assert float(terrain.elevation_m.std()) == pytest.approx(0.008, rel=1e-6)
    assert terrain.height(0.0, 0.0) == pytest.approx(0.0, abs=1e-12)


def test_slope_rises_in_its_direction() -> None:
    relief = Relief(0.0, 0, math.radians(10), math.radians(90))
    terrain = make_ground(relief, (-1.0, -1.0), 4.0, 0.03, np.random.default_rng(0))
    assert terrain.height(0.0, 2.0) == pytest.approx(2 * math.tan(math.radians(10)))
    assert terrain.height(2.0, 0.0) == pytest.approx(0.0, abs=1e-12)


def test_craters_dig_into_the_ground() -> None:
    flat = make_ground(Relief(0.0, craters=8), (-1.0, -4.0), 8.0, 0.03, np.random.default_rng(5))
    span_m = float(np.ptp(flat.elevation_m))
    assert 0.02 < span_m < 0.4


def test_another_seed_makes_other_ground() -> None:
    config = TerrainConfig.model_validate({"procedural": {"width": "8 m"}})
    one, two, again = (make_terrain(config, AHEAD, seed).elevation_m for seed in (1, 2, 1))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, two)


def test_route_beyond_the_ground_is_refused_with_the_side_named() -> None:
    config = TerrainConfig.model_validate({"procedural": {"width": "8 m"}})
    with pytest.raises(TerrainError, match=r"needs x = 7\.75 m, the ground has nothing above 6\.0\d m"):
        make_terrain(config, route((3.0, 0.0), (7.0, 0.0)), 0)


def test_window_of_a_geotiff_is_cut_with_y_up_and_placed_at_the_lander(tmp_path: Path) -> None:
    rows, cols, cell_m = 60, 80, 0.25
    x = np.arange(cols) * cell_m
    y = (rows - 1 - np.arange(rows)) * cell_m  # the first row of an image is the highest y
    path = write_tiff(tmp_path / "plane.tif", 0.1 * x[None, :] + 0.03 * y[:, None], cell_m)
    model = read_model(path)
    terrain = cut(model, Window(5.0, 4.0, 8.0), None, 1.0, 0.03)
    assert model.cell_m == pytest.approx(cell_m)
    assert terrain.cell_m <= 0.03
    assert terrain.origin_site_m == pytest.approx((-2.0, -4.0))
    assert terrain.corner_site_m == pytest.approx((6.0, 4.0))
    assert terrain.height(3.0, 1.0) == pytest.approx(0.3 + 0.03, abs=1e-6)
    assert terrain.height(0.0, 0.0) == pytest.approx(0.0, abs=1e-12)


def test_scale_enlarges_all_three_axes(tmp_path: Path) -> None:
    bumps = np.random.default_rng(0).standard_normal((40, 40)) * 0.1
    model = read_model(write_tiff(tmp_path / "bumps.tif", bumps, 0.25))
    one, two = (cut(model, Window(1.0, 1.0, 6.0), (1.0, 2.0), s, 0.03) for s in (1.0, 2.0))
    assert two.height(2 * 1.7, 2 * 0.6) == pytest.approx(2 * one.height(1.7, 0.6), abs=6e-3)
    assert two.origin_site_m == pytest.approx((-2.0, -4.0))


def test_npy_needs_its_cell_size(tmp_path: Path) -> None:
    path = tmp_path / "ground.npy"
    np.save(path, np.zeros((20, 20)))
    with pytest.raises(TerrainError, match="give `cell`"):
        read_model(path)
    assert read_model(path, 0.5).size_m == (9.5, 9.5)


@pytest.mark.parametrize(
    ("window", "message"),
    [(Window(8.0, 0.0, 8.0), "leaves the elevation model"), (Window(-1.0, 0.0, 4.0), "leaves the elevation")],
)
def test_window_that_leaves_the_model_is_refused(tmp_path: Path, window: Window, message: str) -> None:
    model = read_model(write_tiff(tmp_path / "flat.tif", np.zeros((48, 48)), 0.25))
    with pytest.raises(TerrainError, match=message):
        cut(model, window, None, 1.0, 0.03)


def test_holes_in_the_survey_are_refused(tmp_path: Path) -> None:
    heights = np.zeros((20, 20))
    heights[3, 4] = -9999
    with pytest.raises(TerrainError, match="1 cells hold no height"):
        read_model(write_tiff(tmp_path / "holes.tif", heights, 0.25, hole="-9999"))


@pytest.mark.parametrize("name", ["absent.tif", "text.tif", "text.csv"])
def test_unreadable_models_are_named(tmp_path: Path, name: str) -> None:
    if name.startswith("text"):
        (tmp_path / name).write_text("not a model")
    with pytest.raises(TerrainError, match=name):
        read_model(tmp_path / name)


@pytest.mark.skipif(not REAL_MODEL.is_file(), reason="the surveyed Mars yard is not on this machine")
def test_real_mars_yard_is_read_in_metres() -> None:
    model = read_model(REAL_MODEL)
    assert model.size_m == pytest.approx((46.906, 46.906))
    terrain = cut(model, Window(12.0, 20.0, 24.0), None, 1.0, 0.03)
    assert terrain.origin_site_m == pytest.approx((-2.0, -12.0))
    column, row = round(15.0 / model.cell_m), round(33.0 / model.cell_m)
    place = (column * model.cell_m - 14.0, row * model.cell_m - 32.0)  # the same survey point, in site
    lander = model.heights_m[round(32.0 / model.cell_m), round(14.0 / model.cell_m)]
    surveyed = model.heights_m[row, column] - lander
    assert terrain.height(*place) == pytest.approx(surveyed, abs=0.02)


def test_generators_of_components_do_not_shift_each_other() -> None:
    assert generator(3, "rocks").random() == generator(3, "rocks").random()
    assert generator(3, "rocks").random() != generator(3, "soil").random()
