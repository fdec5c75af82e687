"""LEDs in images: where their light lands, how much of it, and what hides it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from executive.core.types import Window
from sim_pybullet.picture import Picture
from sim_pybullet.terrain import Terrain
from tests.sim_pybullet.sensor_scenes import (
    RIG,
    flat_ground,
    held_up,
    level_view,
    mean_difference_e,
    picture,
    scene_at,
    with_rock,
)

_PAIRS = 600


@pytest.mark.parametrize("range_m", [3.0, 8.0])
@pytest.mark.parametrize(("du", "dv"), [(0.0, 0.0), (0.13, -0.41), (0.25, 0.25), (-0.37, 0.08), (0.5, -0.5)])
def test_centroid_of_an_led_is_where_it_is_at_any_sub_pixel_phase(range_m, du, dv):
    scene = held_up(level_view(), 511 + du, 511 + dv, range_m, 60.0 * (range_m / 5) ** 2)
    window = Window(504, 504, 15, 15)
    image = mean_difference_e(picture(), scene, window, 3000)
    offset = np.arange(-7, 8)
    total = image.sum()
    assert (image.sum(axis=0) @ offset) / total == pytest.approx(du, abs=0.01)
    assert (image.sum(axis=1) @ offset) / total == pytest.approx(dv, abs=0.01)


def _signal(pic: Picture, scene, index: int = 0, half: int = 5) -> tuple[float, float]:
    """Difference signal about a marker of a scene on the ground, and its standard error [e-]."""
    spot = pic.spots(replace(scene, rocks=(), led_alive=(True,) * 4), 0)[index]
    window = Window(round(spot.u_px) - half, round(spot.v_px) - half, 2 * half + 1, 2 * half + 1)
    dark = replace(scene, led_factor=tuple(30.0 * (i == index) for i in range(4)))
    image = _difference(pic, dark, window, 1 << index)
    noise_e = math.sqrt(2 / _PAIRS) * pic.exposure.noise_counts * pic.exposure.gain_e
    return float(image.sum()), noise_e * math.sqrt(image.size)


def _difference(pic: Picture, scene, window: Window, leds: int):
    from sim_pybullet.sensor import Sensor

    sensor = Sensor(pic.exposure, np.random.default_rng(4))
    unlit = pic.unlit_e(scene, 0, window)
    lit = pic.lit_e(unlit, pic.spots(scene, 0), leds, window)
    on, off = sensor.expose(lit, _PAIRS), sensor.expose(unlit, _PAIRS)
    return (on.mean(axis=0) - off.mean(axis=0)) * pic.exposure.gain_e


def test_every_marker_of_a_rover_in_the_open_is_seen():
    pic, scene = picture(), scene_at(flat_ground(), 3.0, 0.0)
    for index in range(4):
        signal, error = _signal(pic, scene, index)
        assert signal > 20 * error


def test_led_behind_a_rock_gives_no_signal():
    pic, scene = picture(), scene_at(flat_ground(), 3.0, 0.0)
    marker = scene.T_site_plc[:3, 3]
    eye = pic.view(scene, 0).position_site_m
    hidden = with_rock(scene, marker + 0.25 * (eye - marker), 0.15)
    signal, error = _signal(pic, hidden)
    assert abs(signal) < 4 * error


def test_led_behind_a_ridge_gives_no_signal():
    elevation = np.zeros((400, 300))
    elevation[:, 84:94] = 0.9  # between the mast and the rover, 2.2 to 2.7 m ahead
    ridge = Terrain(elevation, (-2.0, -10.0), 0.05)
    scene = scene_at(flat_ground(), 4.0, 0.0)
    signal, error = _signal(picture(ridge), scene)
    assert abs(signal) < 4 * error


def test_led_on_a_plane_turned_away_is_hidden_by_the_cabin():
    pic = picture()
    scene = scene_at(flat_ground(), 5.0, 0.0, heading_rad=math.pi, cabin=math.radians(60))
    signal, error = _signal(pic, scene)
    assert abs(signal) < 4 * error
    toward = scene_at(flat_ground(), 5.0, 0.0, heading_rad=0.0, cabin=math.radians(60))
    assert _signal(pic, toward)[0] > 20 * error


def test_dead_led_gives_no_signal_and_a_dim_one_its_share():
    pic, scene = picture(), scene_at(flat_ground(), 3.0, 0.0)
    signal, error = _signal(pic, replace(scene, led_alive=(False, True, True, True)))
    assert abs(signal) < 4 * error
    bright, dim = (
        mean_difference_e(
            pic,
            replace(held_up(level_view(), 511.5, 511.5, 5.0), led_factor=(f,) * 4),
            Window(504, 504, 16, 16),
            400,
        ).sum()
        for f in (40.0, 10.0)
    )
    assert dim / bright == pytest.approx(0.25, rel=0.05)


def test_light_falls_with_the_square_of_the_distance():
    pic = picture()
    near, far = (
        mean_difference_e(
            pic, held_up(level_view(), 511.5, 511.5, d, 60.0), Window(503, 503, 18, 18), 500
        ).sum()
        for d in (4.0, 8.0)
    )
    assert near / far == pytest.approx(4.0, rel=0.05)


def test_emission_follows_the_calibrated_pattern():
    scene = scene_at(flat_ground(), 3.0, 0.0)
    dome = picture().spots(scene, 0)[0].electrons
    rig = replace(RIG, markers=replace(RIG.markers, emission="lambertian"))
    lambertian = picture(rig=rig).spots(scene, 0)[0].electrons
    eye = picture().view(scene, 0).position_site_m
    marker = scene.T_site_plc @ np.append(RIG.markers.positions_plc_m[0], 1.0)
    cosine = (eye - marker[:3]) @ scene.T_site_plc[:3, 2] / np.linalg.norm(eye - marker[:3])
    assert lambertian / dome == pytest.approx(cosine / ((1 + cosine) / 2), rel=1e-6)
