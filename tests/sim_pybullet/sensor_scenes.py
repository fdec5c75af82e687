"""Scenes for the sensor's tests: a rover on flat or rough ground, or held up in front of a camera."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Array, Window
from sim_pybullet.picture import Picture
from sim_pybullet.projection import PlacedCamera, about_y, about_z, head_views
from sim_pybullet.scene import Rock, SceneState
from sim_pybullet.sensor import Sensor
from sim_pybullet.sunlight import Sun
from sim_pybullet.terrain import Terrain

RIG = RigCalibration()
SUN = Sun(math.radians(35.0), math.radians(60.0))


def transform(R: Array, t_m: object) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t_m
    return T


def flat_ground(height_m: float = 0.0) -> Terrain:
    return Terrain(np.full((400, 700), height_m), (-2.0, -10.0), 0.05)


def rough_ground(seed: int = 5) -> Terrain:
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:300, 0:400] * 0.04
    waves = sum(
        0.02 * np.sin(rng.uniform(0.5, 4) * x + rng.uniform(0.5, 4) * y + rng.uniform(0, 6)) for _ in range(6)
    )
    return Terrain(np.asarray(waves), (-2.0, -6.0), 0.04)


def picture(terrain: Terrain | None = None, rig: RigCalibration = RIG, sun: Sun = SUN) -> Picture:
    return Picture(rig, terrain or flat_ground(), sun, np.random.default_rng(1))


def scene_of_body(T_site_body: Array, pan_rad: float, tilt_rad: float, arm=0.0, cabin=0.0) -> SceneState:
    c = RIG.cabin
    T_arm = T_site_body @ transform(about_y(-arm), c.arm_pivot_body_m)
    T_cabin = T_arm @ transform(about_y(arm - cabin), (c.arm_length_m, 0, 0))
    T_plc = T_cabin @ transform(np.eye(3), c.plc_offset_cabin_m)
    return SceneState(0.0, T_site_body, T_arm, T_cabin, T_plc, arm, cabin, pan_rad, tilt_rad)


def scene_at(terrain: Terrain, x_m: float, y_m: float, heading_rad: float = 0.3, **joints) -> SceneState:
    """The rover on the ground (level), the head pointed at it."""
    z = terrain.height(x_m, y_m)
    drop = RIG.head.mast_height_m - z - 0.1
    tilt = math.atan2(drop, math.hypot(x_m, y_m))
    T = transform(about_z(heading_rad), (x_m, y_m, z))
    return scene_of_body(T, math.atan2(y_m, x_m), tilt, **joints)


def held_up(view: PlacedCamera, u_px: float, v_px: float, depth_m: float, factor: float = 1.0) -> SceneState:
    """Marker 0 at this pixel and depth of `view`, its plane facing the camera; the head looks level ahead."""
    marker = view.position_site_m + depth_m * view.rays(np.array(u_px), np.array(v_px))
    R_site_plc = np.column_stack([-view.R_site_cam[:, 1], view.R_site_cam[:, 0], -view.R_site_cam[:, 2]])
    T_site_plc = transform(R_site_plc, marker - R_site_plc @ np.array(RIG.markers.positions_plc_m[0]))
    body_plc = scene_of_body(np.eye(4), 0.0, 0.0).T_site_plc
    scene = scene_of_body(T_site_plc @ np.linalg.inv(body_plc), 0.0, 0.0)
    return replace(scene, led_factor=(factor,) * 4)


def level_view(camera: int = 0) -> PlacedCamera:
    return head_views(RIG, 0.0, 0.0)[camera]


def with_rock(scene: SceneState, centre_m: Array, radius_m: float) -> SceneState:
    rock = Rock((float(centre_m[0]), float(centre_m[1]), float(centre_m[2])), radius_m)
    return replace(scene, rocks=(*scene.rocks, rock))


def mean_difference_e(
    pic: Picture, scene: SceneState, window: Window, pairs: int, seed: int = 0, camera: int = 0
) -> Array:
    """Mean over pairs of (marker 0 on) - (off) from simulated counts, in electrons."""
    return differences_counts(pic, scene, window, pairs, seed, camera).mean(axis=0) * pic.exposure.gain_e


def differences_counts(
    pic: Picture, scene: SceneState, window: Window, pairs: int, seed: int = 0, camera: int = 0
) -> Array:
    """(pairs, h, w) difference images of marker 0 in counts."""
    sensor = Sensor(pic.exposure, np.random.default_rng(seed))
    unlit = pic.unlit_e(scene, camera, window)
    lit = pic.lit_e(unlit, pic.spots(scene, camera), 1, window)
    on, off = sensor.expose(lit, pairs), sensor.expose(unlit, pairs)
    return on.astype(np.float32) - off.astype(np.float32)
