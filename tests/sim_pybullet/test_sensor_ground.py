"""The picture of ground, rocks and rover: geometry and light where they can be checked by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from executive.core.types import Array, Window
from sim_pybullet.projection import about_z, distort, head_views, undistort
from sim_pybullet.raycast import HeightField
from sim_pybullet.sunlight import Sun, sunlit_share
from sim_pybullet.terrain import Terrain
from tests.sim_pybullet.sensor_scenes import (
    RIG,
    SUN,
    flat_ground,
    level_view,
    picture,
    rough_ground,
    scene_at,
    scene_of_body,
    transform,
    with_rock,
)

_FAR_AWAY = scene_of_body(transform(np.eye(3), (-500.0, 0.0, 0.0)), 0.0, math.radians(30.0))


def test_rays_through_the_pixels_of_points_pass_through_the_points():
    lens = replace(RIG.cameras[0], distortion=(-0.08, 0.02, 1e-3, -5e-4, 0.0))
    view = head_views(replace(RIG, cameras=(lens, RIG.cameras[1])), 0.4, 0.3)[0]
    uv, v = np.array([3.0, 511.5, 1020.0]), np.array([1000.0, 511.5, 40.0])
    points = view.position_site_m + 4.0 * view.rays(uv, v)
    back, depth = view.project(points)
    np.testing.assert_allclose(back, np.column_stack([uv, v]), atol=1e-6)
    np.testing.assert_allclose(depth, 4.0)


def test_undistortion_inverts_distortion():
    lens = replace(RIG.cameras[0], distortion=(-0.2, 0.1, 2e-3, 1e-3, 0.05))
    x, y = np.meshgrid(np.linspace(-0.2, 0.2, 9), np.linspace(-0.2, 0.2, 9))
    for got, want in zip(undistort(lens, *distort(lens, x, y)), (x, y), strict=True):
        np.testing.assert_allclose(got, want, atol=1e-10)


def test_panning_left_and_tilting_down_move_a_point_right_and_up():
    point = np.array([5.0, 0.0, 1.0])
    (u, v), _ = level_view().project(point)
    (u_left, _), _ = head_views(RIG, 0.05, 0.0)[0].project(point)
    (_, v_down), _ = head_views(RIG, 0.0, 0.05)[0].project(point)
    assert u_left == pytest.approx(u + 125, rel=0.05)
    assert v_down == pytest.approx(v - 125, rel=0.05)


def test_left_camera_looks_to_the_right_of_the_right_one():
    left, right = head_views(RIG, 0.0, 0.0)
    assert left.position_site_m[1] > right.position_site_m[1]
    point = np.array([1.0 / math.tan(math.radians(5)) * 0.25, 0.0, RIG.head.mast_height_m])
    for view in (left, right):
        np.testing.assert_allclose(view.project(point)[0], (511.5, 511.5), atol=1e-6)


def _plane(rise: float) -> Terrain:
    x = -2.0 + 0.05 * np.arange(700)
    return Terrain(np.tile(rise * x, (400, 1)), (-2.0, -10.0), 0.05)


@pytest.mark.parametrize("rise", [-0.1, 0.0, 0.15])
def test_rays_meet_a_plane_where_geometry_says(rise):
    view = head_views(RIG, 0.1, math.radians(20.0))[1]
    rays = view.rays(*np.meshgrid(np.linspace(0, 1023, 9), np.linspace(100, 1023, 9))).reshape(-1, 3)
    depth = HeightField(_plane(rise)).cast(view.position_site_m, rays)
    x0, _, z0 = view.position_site_m
    exact = (rise * x0 - z0) / (rays[:, 2] - rise * rays[:, 0])
    np.testing.assert_allclose(depth, exact, rtol=2e-3)


def test_rays_over_rough_ground_end_on_it_and_do_not_pass_through_it():
    ground = rough_ground()
    view = head_views(RIG, 0.0, math.radians(12.0))[0]
    rays = view.rays(*np.meshgrid(np.linspace(0, 1023, 21), np.linspace(300, 1023, 21))).reshape(-1, 3)
    depth = HeightField(ground).cast(view.position_site_m, rays)
    ends = view.position_site_m + depth[:, None] * rays
    assert np.abs(ends[:, 2] - ground.heights(ends[:, 0], ends[:, 1])).max() < 0.004
    for share in np.linspace(0.05, 0.97, 60):
        on_way = view.position_site_m + share * depth[:, None] * rays
        assert (on_way[:, 2] > ground.heights(on_way[:, 0], on_way[:, 1]) - 0.004).all()


def test_rays_above_the_horizon_meet_nothing():
    view = level_view()
    rays = view.rays(np.array([100.0, 900.0]), np.array([100.0, 300.0]))
    assert np.isinf(HeightField(flat_ground()).cast(view.position_site_m, rays)).all()


def test_sunlit_ground_fills_40_per_cent_of_the_well_with_about_10_per_cent_contrast():
    image = picture().unlit_e(_FAR_AWAY, 0, Window(0, 0, 1024, 1024))
    assert image.mean() / 160e3 == pytest.approx(0.40, rel=0.04)
    assert 0.05 < image.std() / image.mean() < 0.15


def test_a_window_shows_the_same_as_the_full_frame():
    pic, scene = picture(rough_ground()), scene_at(rough_ground(), 3.0, 0.2)
    scene = with_rock(scene, np.array([2.9, 0.5, 0.0]), 0.06)
    window = Window(403, 377, 230, 190)
    full = pic.unlit_e(scene, 0, Window(0, 0, 1024, 1024))
    part = full[window.v : window.v + window.height, window.u : window.u + window.width]
    difference = np.abs(pic.unlit_e(scene, 0, window) - part) / part
    assert np.quantile(difference, 0.99) < 0.01


def test_a_wall_shades_the_ground_behind_it_as_far_as_the_sun_is_low():
    elevation = np.zeros((200, 200))
    elevation[:, 98:102] = 0.5
    terrain = Terrain(elevation, (0.0, 0.0), 0.02)
    lit = sunlit_share(terrain, Sun(math.radians(30.0), 0.0))  # the sun stands at +x
    shaded = np.flatnonzero(lit[100, :97] < 0.5)
    assert 0.02 * len(shaded) == pytest.approx(0.5 / math.tan(math.radians(30.0)), abs=0.06)
    assert (lit[100, 102:] > 0.5).all()


def _rover_mask(scene, window: Window, camera: int = 0) -> Array:
    pic = picture()
    with_rover = pic.unlit_e(scene, camera, window)
    away = replace(
        _FAR_AWAY, head_pan_rad=scene.head_pan_rad, head_tilt_rad=scene.head_tilt_rad, rocks=scene.rocks
    )
    without = pic.unlit_e(away, camera, window)
    return np.abs(with_rover / without - 1) > 0.03


def test_the_rover_shows_where_its_marker_plane_projects():
    scene = scene_at(flat_ground(), 3.0, 0.0, heading_rad=0.7)
    window = Window(300, 300, 424, 424)
    mask = _rover_mask(scene, window)
    corners = np.array([[x, y, 0.0, 1.0] for x in (-0.08, 0.08) for y in (-0.06, 0.06)])
    uv, _ = head_views(RIG, scene.head_pan_rad, scene.head_tilt_rad)[0].project(
        (corners @ scene.T_site_plc.T)[:, :3]
    )
    for u, v in uv - (window.u, window.v):
        near = mask[int(v) - 6 : int(v) + 7, int(u) - 6 : int(u) + 7]
        assert near.any()
        assert not near.all() or v > uv[:, 1].min() - window.v + 10


def test_the_rover_casts_its_shadow_away_from_the_sun():
    scene = scene_at(flat_ground(), 3.0, 0.0, heading_rad=0.0)
    window = Window(200, 200, 624, 624)
    pic, view = picture(), head_views(RIG, scene.head_pan_rad, scene.head_tilt_rad)[0]
    image = pic.unlit_e(scene, 0, window) / pic.exposure.ground_e
    toward = SUN.direction_site * (1, 1, 0)
    beside = toward / np.linalg.norm(toward) * 0.15

    def brightness(point: Array) -> float:
        u, v = np.round(view.project(point)[0]).astype(int) - (window.u, window.v)
        return float(image[v - 3 : v + 4, u - 3 : u + 4].mean())

    foot = scene.T_site_body[:3, 3]
    assert brightness(foot - beside) < 0.5
    assert brightness(foot + 1.3 * beside) > 0.8


def test_a_rover_that_moves_changes_the_image_only_about_itself():
    pic, window = picture(), Window(0, 0, 1024, 1024)
    scene = scene_at(flat_ground(), 4.0, 0.0)
    moved = scene_at(flat_ground(), 4.0, 0.03)
    moved = replace(moved, head_pan_rad=scene.head_pan_rad, head_tilt_rad=scene.head_tilt_rad)
    changed = np.abs(pic.unlit_e(moved, 0, window) - pic.unlit_e(scene, 0, window)) > 500
    rows, columns = np.nonzero(changed)
    middle, _ = pic.view(scene, 0).project(scene.T_site_body[:3, 3])
    assert changed.sum() > 500
    assert np.hypot(columns - middle[0], rows - middle[1]).max() < 0.5 * 2500 / 4.0


def test_a_rock_in_front_hides_the_rover_and_one_behind_does_not():
    scene = scene_at(flat_ground(), 4.0, 0.0)
    window = Window(400, 400, 224, 224)
    middle = scene.T_site_body[:3, 3] + (0, 0, 0.1)
    eye = picture().view(scene, 0).position_site_m
    toward = (eye - middle) / np.linalg.norm(eye - middle)
    u, v = np.round(picture().view(scene, 0).project(middle)[0]).astype(int) - (400, 400)
    open_view = picture().unlit_e(scene, 0, window)[v, u]
    behind = picture().unlit_e(with_rock(scene, middle - 0.5 * toward, 0.08), 0, window)[v, u]
    before = picture().unlit_e(with_rock(scene, middle + 0.5 * toward, 0.08), 0, window)[v, u]
    assert behind == open_view
    assert before != open_view


def test_same_generator_state_gives_the_same_ground():
    window = Window(300, 300, 96, 96)
    first, second = (picture(rough_ground()).unlit_e(_FAR_AWAY, 0, window) for _ in range(2))
    assert (first == second).all()


def test_shadows_turn_with_the_sun():
    assert about_z(0.3) @ Sun(0.6, 0.2).direction_site == pytest.approx(Sun(0.6, 0.5).direction_site)


@pytest.mark.parametrize("elevation_deg", [0.0, 5.0, 90.0])
def test_any_sun_over_the_horizon_makes_a_picture(elevation_deg):
    sun = Sun(math.radians(elevation_deg), 1.0)
    scene = with_rock(scene_at(flat_ground(), 3.0, 0.0), np.array([2.9, 0.2, 0.0]), 0.05)
    image = picture(flat_ground(), sun=sun).unlit_e(scene, 0, Window(400, 400, 200, 200))
    assert np.isfinite(image).all()
    assert image.min() > 0
    assert image.std() > 0
