"""The cheap tier against its promises and against images of the full tier."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from executive.core.types import (
    Centres,
    HeadReading,
    Shot,
    Window,
)
from sim_pybullet.error_model import FLOOR_PX, centre_error
from sim_pybullet.geometric import CentreDeveloper, middle_sigma_px
from sim_pybullet.leds import MarkerOptics, Spot, add_spot
from sim_pybullet.radiometry import Exposure, calibrated_light, line_spread, spread_sigma_px
from sim_pybullet.raycast import HeightField
from sim_pybullet.seeing import CLEAN, Lens, Seeing
from sim_pybullet.sensor import Sensor
from tests.sim_pybullet.sensor_scenes import (
    RIG,
    flat_ground,
    picture,
    scene_at,
    with_rock,
)

_EXPOSURE = Exposure(10)
_HEAD = HeadReading(0.0, 0.0, 0.0, False)


def _developer(seed: int = 1) -> CentreDeveloper:
    field, rng = HeightField(flat_ground()), np.random.default_rng(seed)
    optics = MarkerOptics(RIG, calibrated_light(RIG), field)
    return CentreDeveloper(optics, _EXPOSURE, field, rng)


def _sequence(pairs: int) -> tuple[int, ...]:
    return (0, 1, 2, 4, 8) * pairs


def _centres(shot: Shot, scene, times: int = 1, seed: int = 1) -> list[Centres]:
    developer = _developer(seed)
    return [developer.develop(shot, (scene,) * len(shot.leds), _HEAD, 0.0) for _ in range(times)]


def _true_uv(scene) -> np.ndarray:
    pic = picture()
    return np.array([[(s.u_px, s.v_px) for s in pic.spots(scene, camera)] for camera in (0, 1)])


def test_centres_scatter_about_the_projection_as_much_as_they_say():
    scene = scene_at(flat_ground(), 3.0, 0.0)
    answers = _centres(Shot(_sequence(30)), scene, 400)
    errors = np.array([a.uv_px for a in answers]) - _true_uv(scene)
    sigma = answers[0].sigma_px
    assert np.isfinite(errors).all()
    assert np.abs(errors.mean(axis=0)).max() < 5 * sigma.max() / math.sqrt(400)
    np.testing.assert_allclose(errors.std(axis=0).mean(axis=-1), sigma, rtol=0.12)


def test_more_pairs_give_better_centres():
    scene = scene_at(flat_ground(), 4.0, 0.0)
    few, many = (np.nanmean(_centres(Shot(_sequence(n)), scene)[0].sigma_px) for n in (30, 120))
    assert few / many == pytest.approx(2.0, rel=0.05)


def test_a_coded_shot_shows_all_markers_of_a_far_rover_or_none():
    codes = (15, 0, 3, 12, 9, 6, 5, 10)
    scene = scene_at(flat_ground(), 15.0, 0.0)
    shown = {}
    for pairs in (16, 64, 400):
        found = [np.isfinite(a.uv_px).all(axis=(-1)) for a in _centres(Shot(codes * (pairs // 4)), scene, 40)]
        assert all(camera.all() or not camera.any() for one in found for camera in one)
        shown[pairs] = np.mean([camera.all() for one in found for camera in one])
    assert shown[16] < 0.2
    assert shown[16] < shown[64] <= shown[400]
    assert shown[400] > 0.95


def test_in_a_code_an_led_has_the_centre_that_as_many_pairs_of_its_own_would_give():
    scene = scene_at(flat_ground(), 4.0, 0.0)
    coded = _centres(Shot((15, 0, 3, 12, 9, 6, 5, 10) * 8), scene)[0]
    alone = _centres(Shot((*_sequence(32), 0)), scene)[0]
    np.testing.assert_allclose(coded.sigma_px, alone.sigma_px, rtol=0.03)


def test_far_markers_are_not_found_in_few_pairs():
    near, far = (
        np.isfinite(
            [c.uv_px for c in _centres(Shot(_sequence(4)), scene_at(flat_ground(), d, 0.0), 60)]
        ).mean()
        for d in (2.0, 9.0)
    )
    assert near > 0.95
    assert far < 0.05


def test_hidden_dead_unlit_and_out_of_window_markers_are_missing():
    scene = scene_at(flat_ground(), 2.5, 0.0)
    true = _true_uv(scene)
    eye = picture().view(scene, 0).position_site_m
    marker = (scene.T_site_plc @ np.append(RIG.markers.positions_plc_m[1], 1.0))[:3]
    blocked = with_rock(scene, marker + 0.05 * (eye - marker), 0.02)
    blocked = replace(blocked, led_alive=(True, True, True, False))
    shot = Shot((0, 1, 2, 8) * 20)
    uv = _centres(shot, blocked)[0].uv_px
    assert np.isfinite(uv[:, 0]).all()
    assert np.isnan(uv[0, 1]).all()
    assert np.isnan(uv[:, 2:]).all()
    u, v = np.round(true[0, 0]).astype(int)
    window = Window(int(u) - 15, int(v) - 15, 31, 31)
    uv = _centres(Shot(_sequence(20), (window, window)), scene)[0].uv_px
    assert np.isfinite(uv[0, 0]).all()
    assert np.isnan(uv[0, 2]).all()


def test_a_sequence_without_a_dark_frame_finds_nothing():
    assert np.isnan(_centres(Shot((1, 2, 4, 8) * 20), scene_at(flat_ground(), 2.0, 0.0))[0].uv_px).all()


def test_without_light_the_middle_of_the_rover_is_the_answer():
    scenes = [scene_at(flat_ground(), 4.0, y) for y in (0.0, 0.03)]
    scenes = [replace(s, head_pan_rad=0.0) for s in scenes]
    developer = _developer()
    answers = [developer.develop(Shot((0, 0)), tuple(scenes), _HEAD, 0.0) for _ in range(300)]
    uv = np.array([a.uv_px for a in answers])
    assert np.isnan(uv[:, :, 1:]).all()
    for camera in (0, 1):
        views = [picture().view(s, camera) for s in scenes]
        points = [s.T_site_body[:3, 3] + (0, 0, 0.065) for s in scenes]
        middle = np.mean([v.project(p)[0] for v, p in zip(views, points, strict=True)], axis=0)
        sigma_px = middle_sigma_px(picture().rig, float(np.linalg.norm(views[1].position_site_m - points[1])))
        np.testing.assert_allclose(uv[:, camera, 0].mean(axis=0), middle, atol=4 * sigma_px / math.sqrt(300))
        assert uv[:, camera, 0].std(axis=0).mean() == pytest.approx(sigma_px, rel=0.1)


def test_the_middle_shows_as_well_as_an_outline_lies_in_pixels_that_bin_a_rover_near_by():
    rig = picture().rig
    assert middle_sigma_px(rig, 2.0) == pytest.approx(2 * middle_sigma_px(rig, 4.0))
    assert middle_sigma_px(rig, 15.0) == middle_sigma_px(rig, 20.0)


def _fitted(image: np.ndarray, spot: Spot, first: int) -> tuple[float, float]:
    """Least-squares centre of a spot of known spread in a difference image, started at the truth."""
    at = first + np.arange(len(image), dtype=float)
    u, v, h = spot.u_px, spot.v_px, 1e-3

    def model(u: float, v: float) -> np.ndarray:
        line_v, line_u = (line_spread(at - c, spot.size_px, spot.sigma_px) for c in (v, u))
        return np.outer(line_v, line_u)

    for _ in range(6):
        P = model(u, v)
        du, dv = (model(u + h, v) - model(u - h, v)) / (2 * h), (model(u, v + h) - model(u, v - h)) / (2 * h)
        flux = (P * image).sum() / (P * P).sum()
        J = np.stack([P.ravel(), flux * du.ravel(), flux * dv.ravel()], axis=1)
        step = np.linalg.lstsq(J, (image - flux * P).ravel(), rcond=None)[0][1:]
        u, v = u + step[0], v + step[1]
    return u, v


@pytest.mark.parametrize(("range_m", "pairs"), [(2.0, 4), (5.0, 40)])
def test_the_error_model_agrees_with_centres_fitted_in_images(range_m, pairs):
    rng = np.random.default_rng(7)
    sensor = Sensor(_EXPOSURE, rng)
    errors, predicted = [], []
    light = calibrated_light(RIG)
    for _ in range(250):
        u, v = 16 + rng.uniform(-0.5, 0.5, 2)
        size_px = RIG.cameras[0].focal_px * RIG.markers.size_m / range_m
        spot = Spot(u, v, size_px, spread_sigma_px(RIG.sensor, range_m), light.electrons(range_m, 1.0))
        unlit = np.full((33, 33), _EXPOSURE.ground_e, dtype=np.float32)
        lit = unlit.copy()
        add_spot(lit, spot, Window(0, 0, 33, 33))
        image = sensor.expose(lit, pairs).mean(axis=0) - sensor.expose(unlit, pairs).mean(axis=0)
        uv = _fitted(image, spot, 0)
        errors.append(np.array(uv) - (u, v))
        model = centre_error(spot, _EXPOSURE, pairs, pairs)
        predicted.append((model.sigma_u_px, model.sigma_v_px))
        assert model.reported_px >= FLOOR_PX
    rms, said = np.sqrt(np.mean(np.square(errors))), np.sqrt(np.mean(np.square(predicted)))
    assert rms == pytest.approx(said, rel=0.15)


def test_stray_light_that_fills_the_wells_is_said_and_half_the_exposure_shows_the_markers_again():
    scene = scene_at(flat_ground(), 2.0, 0.0)
    lenses = tuple(replace(lens, veil=2.5) for lens in scene.seeing.lenses)
    veiled = replace(scene, seeing=replace(scene.seeing, lenses=lenses))
    clear = _centres(Shot(_sequence(20)), scene)[0]
    full, half = (_centres(Shot(_sequence(20), exposure=e), veiled)[0] for e in (1.0, 0.5))
    assert clear.saturated == half.saturated == (False, False)
    assert full.saturated == (True, True)
    assert not np.isfinite(full.uv_px).any()
    assert np.isfinite(half.uv_px).all()
    assert half.sigma_px.mean() > 1.5 * clear.sigma_px.mean()


def _outlined(scene, windows=None, times=1):
    answers = _centres(Shot((0,) * 8, windows), scene, times)
    return np.array([a.uv_px for a in answers]), answers[0].sigma_px[0, 0]


def test_an_outline_shows_where_dead_markers_are_as_exactly_as_it_says():
    scene = replace(scene_at(flat_ground(), 6.0, 0.0), led_alive=(False,) * 4)
    uv, sigma = _outlined(scene, times=300)
    found = np.isfinite(uv).all(axis=(1, 2, 3))
    assert 0.9 < found.mean() < 1.0
    errors = uv[found] - _true_uv(scene)
    assert np.abs(errors.mean(axis=0)).max() < 5 * sigma / math.sqrt(300)
    np.testing.assert_allclose(errors.std(axis=0), sigma, rtol=0.2)


@pytest.mark.parametrize(
    "seeing", [Seeing(daylight=0.1), Seeing(clouds=3.0), Seeing(lenses=(Lens(blur_px=3.0), CLEAN))]
)
def test_in_the_dark_in_glare_or_through_dust_there_is_no_outline(seeing):
    scene = replace(scene_at(flat_ground(), 6.0, 0.0), seeing=seeing)
    assert np.isnan(_outlined(scene, times=10)[0]).all()


def test_a_rover_that_a_window_cuts_has_no_outline():
    scene = scene_at(flat_ground(), 6.0, 0.0)
    u, v = np.round(_true_uv(scene)[0, 0]).astype(int)
    window = Window(int(u) + 10, int(v) - 200, 400, 400)
    assert np.isnan(_outlined(scene, (window, Window(0, 0, 1024, 1024)), times=10)[0]).all()
