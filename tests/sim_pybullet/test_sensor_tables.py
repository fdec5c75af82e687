"""The paper's tables 3 and 4 and its SNR of 1 at 7.5 m, all measured in simulated images."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from executive.core.types import Window
from sim_pybullet.sensor import Sensor
from sim_pybullet.sunlight import Sun
from tests.sim_pybullet.sensor_scenes import (
    RIG,
    differences_counts,
    held_up,
    level_view,
    mean_difference_e,
    picture,
)

_BRIGHT = 50.0  # areas are ratios of signals, so a brighter LED only lowers their noise


def _around(u_px: float, v_px: float, half: int) -> Window:
    return Window(round(u_px) - half, round(v_px) - half, 2 * half + 1, 2 * half + 1)


def _signal_e(range_m: float, half: int, pairs: int) -> float:
    scene = held_up(level_view(), 511.5, 511.5, range_m, _BRIGHT)
    return float(mean_difference_e(picture(), scene, _around(511.5, 511.5, half), pairs).sum())


@pytest.fixture(scope="module")
def radiance_e() -> float:
    """Signal of a pixel that the LED covers altogether, seen from so near that its image is 37 px wide."""
    scene = held_up(level_view(), 511.5, 511.5, 0.2, _BRIGHT)
    image = mean_difference_e(picture(), scene, _around(511.5, 511.5, 8), 400)
    return float(image[6:11, 6:11].mean())


@pytest.mark.parametrize(
    ("range_m", "paper_px", "half", "pairs"),
    [(1.6, 25.0, 9, 300), (7.5, 1.0, 5, 400), (10.0, 0.6, 5, 800), (20.0, 0.15, 4, 6000)],
)
def test_marker_covers_the_area_of_table_3(radiance_e, range_m, paper_px, half, pairs):
    area_px = _signal_e(range_m, half, pairs) / radiance_e
    assert area_px == pytest.approx((RIG.cameras[0].focal_px * 0.003 / range_m) ** 2, rel=0.05)
    side_px = math.sqrt(area_px)
    rounded = {1.6: math.ceil(side_px) ** 2, 7.5: round(area_px, 1), 10.0: round(area_px, 1)}
    assert rounded.get(range_m, math.ceil(area_px * 20) / 20) == paper_px


def test_single_pixel_difference_snr_is_1_at_7_5_m():
    # The sun behind the camera, as high as makes the marker plane as bright as sunlit level ground.
    pic = picture(sun=Sun(math.radians(41.2), math.pi))
    scene, window = held_up(level_view(), 512.0, 512.0, 7.5), Window(504, 504, 17, 17)
    background = Sensor(pic.exposure, np.random.default_rng(1)).expose(pic.unlit_e(scene, 0, window), 100)
    assert background[:, 8, 8].mean() / 1023 == pytest.approx(0.40, rel=0.08)
    differences = differences_counts(pic, scene, window, 6000)
    mean = differences.mean(axis=0)
    row, column = np.unravel_index(mean.argmax(), mean.shape)
    assert (row, column) == (8, 8)
    assert mean[row, column] / differences[:, row, column].std() == pytest.approx(1.0, rel=0.05)


def _seen(pic, y_m: float, ahead_m: float, camera: int) -> bool:
    """Whether a bright LED at (ahead, left, 0) of the head shows in a difference of two frames."""
    eye = level_view(camera)
    point = np.array([ahead_m, y_m, RIG.head.mast_height_m])
    in_cam = (point - eye.position_site_m) @ eye.R_site_cam
    uv, _ = eye.project(point)
    scene = held_up(eye, uv[0], uv[1], in_cam[2], 20.0 * max(1.0, (ahead_m / 5) ** 2))
    band = Window(0, 496, 1024, 32)
    difference = differences_counts(pic, scene, band, 1, camera=camera)[0]
    return bool(difference.max() > 7 * math.sqrt(2) * pic.exposure.noise_counts)


def _edge_m(seen, inside_m: float, outside_m: float) -> float:
    """Where `seen` turns from true to false, to 1 mm."""
    assert seen(inside_m)
    assert not seen(outside_m)
    while abs(outside_m - inside_m) > 1e-3:
        middle = (inside_m + outside_m) / 2
        inside_m, outside_m = (middle, outside_m) if seen(middle) else (inside_m, middle)
    return inside_m


def _width_m(seen, ahead_m: float, middle_m: float) -> float:
    left = _edge_m(seen, middle_m, middle_m + ahead_m)
    right = _edge_m(seen, middle_m, middle_m - ahead_m)
    return left - right


@pytest.mark.parametrize(("ahead_m", "paper_m"), [(1.6, 0.655), (10.0, 4.096), (20.0, 8.192)])
def test_mono_width_is_that_of_table_4(ahead_m, paper_m):
    left = RIG.cameras[0]
    rig = replace(RIG, cameras=(replace(left, position_ih_m=(0, 0, 0), yaw_ih_rad=0.0), RIG.cameras[1]))
    pic = picture(rig=rig)

    def seen(y_m: float) -> bool:
        return _seen_straight(pic, y_m, ahead_m)

    assert _width_m(seen, ahead_m, 0.0) == pytest.approx(paper_m, rel=0.05)


def _seen_straight(pic, y_m: float, ahead_m: float) -> bool:
    eye = pic.view(held_up(level_view(), 511.5, 511.5, 1.0), 0)
    u_px = 511.5 - RIG.cameras[0].focal_px * y_m / ahead_m
    scene = held_up(eye, u_px, 511.5, ahead_m, 20.0 * max(1.0, (ahead_m / 5) ** 2))
    difference = differences_counts(pic, scene, Window(0, 496, 1024, 32), 1)[0]
    return bool(difference.max() > 7 * math.sqrt(2) * pic.exposure.noise_counts)


@pytest.mark.parametrize(("ahead_m", "paper_m"), [(1.6, 0.448), (10.0, 2.779), (20.0, 5.057)])
def test_stereo_overlap_is_that_of_table_4(ahead_m, paper_m):
    pic = picture()

    def seen(y_m: float) -> bool:
        return _seen(pic, y_m, ahead_m, 0) and _seen(pic, y_m, ahead_m, 1)

    assert _width_m(seen, ahead_m, 0.0) == pytest.approx(paper_m, rel=0.05)
