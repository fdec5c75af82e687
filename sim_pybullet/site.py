"""The site of a scenario: its ground, soils, rocks, and how the rover stands at the start."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.chance import generator
from executive.core.rig import RigCalibration
from executive.core.types import (
    Array,
    Quat,
    Segment,
    Vec3,
)
from sim_pybullet.config import ProceduralConfig, TerrainConfig, WorldConfig, soil_of
from sim_pybullet.elevation_model import Window, cut, read_model, roughen
from sim_pybullet.procedural import Relief, make_ground
from sim_pybullet.rocks import obstacle, scatter
from sim_pybullet.scene import Rock
from sim_pybullet.shape import belt
from sim_pybullet.soil import Patch, SoilMap
from sim_pybullet.terrain import CELL_M, ROUTE_MARGIN_M, Area, Terrain, area_of, require_cover

ROCK_MARGIN_M = 1.5
HEADING_SPREAD_RAD = math.radians(10.0)
SPAWN_GAP_M = 0.002


def make_terrain(config: TerrainConfig, route: tuple[Segment, ...], seed: int) -> Terrain:
    """The ground of the scenario; TerrainError if it cannot be made or does not cover the route."""
    rng = generator(seed, "terrain")
    if config.dem is not None:
        w = config.window
        window = Window(w.x, w.y, w.width) if w is not None else None
        lander = (config.lander.x, config.lander.y) if config.lander is not None else None
        surveyed = cut(read_model(config.dem, config.cell), window, lander, config.scale, CELL_M)
        terrain = roughen(surveyed, config.added_roughness, rng)
    else:
        p = config.procedural or ProceduralConfig()
        lander_m = (config.lander.x, config.lander.y) if config.lander else (2.0, p.width / 2)
        relief = Relief(p.roughness, p.craters, p.slope, p.slope_direction)
        terrain = make_ground(relief, (-lander_m[0], -lander_m[1]), p.width, CELL_M, rng)
    require_cover(terrain.origin_site_m, terrain.corner_site_m, area_of(route, ROUTE_MARGIN_M))
    return terrain


def make_rocks(
    config: WorldConfig, terrain: Terrain, route: tuple[Segment, ...], rig: RigCalibration, seed: int
) -> tuple[Rock, ...]:
    """Scattered rocks around the route, then the obstacles asked for, in their order."""
    t = config.terrain
    count = t.rocks + (t.procedural.rocks if t.procedural else 0)
    wide = area_of(route, ROCK_MARGIN_M)
    low, high = terrain.origin_site_m, terrain.corner_site_m
    area = Area(
        (max(wide.low_site_m[0], low[0]), max(wide.low_site_m[1], low[1])),
        (min(wide.high_site_m[0], high[0]), min(wide.high_site_m[1], high[1])),
    )
    rocks = scatter(count, area, terrain, route, rig.rover, generator(seed, "rocks"))
    asked = tuple(obstacle(terrain, o.at.x, o.at.y, o.radius, o.height) for o in config.obstacles)
    return rocks + asked


def make_soils(config: WorldConfig, seed: int) -> SoilMap:
    """The soil map with its scatter fields."""
    patches = tuple(Patch((p.at.x, p.at.y), p.radius, soil_of(p.soil)) for p in config.soil.patches)
    return SoilMap(soil_of(config.soil.default), patches, generator(seed, "soil"))


def start_pose(
    config: WorldConfig, terrain: Terrain, route: tuple[Segment, ...], rig: RigCalibration, seed: int
) -> tuple[Vec3, Quat]:
    """Where the rover is set down: at the first way-point with its position error, just above the ground."""
    rng = generator(seed, "start")
    error_m = rng.standard_normal(2) * config.start.position_error
    spread = float(rng.uniform(-HEADING_SPREAD_RAD, HEADING_SPREAD_RAD))
    x, y = route[0].start.x_m + float(error_m[0]), route[0].start.y_m + float(error_m[1])
    heading = config.start.heading
    if heading is None:
        heading = math.atan2(route[0].start.y_m, route[0].start.x_m) + spread
    up = np.array(terrain.normal(x, y, rig.rover.length_m))
    ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
    ahead -= up * float(ahead @ up)
    ahead /= np.linalg.norm(ahead)
    rotation = np.column_stack([ahead, np.cross(up, ahead), up])
    return (x, y, resting_height(terrain, rotation, x, y, rig)), _quaternion(rotation)


def resting_height(terrain: Terrain, rotation: Array, x: float, y: float, rig: RigCalibration) -> float:
    """The lowest height of the body's origin at which no point of the belts' soles lies in the ground."""
    b = belt(rig)
    along = np.linspace(-b.length_m / 2, b.length_m / 2, 24)
    across = (rig.rover.track_gauge_m + b.width_m * np.linspace(-1, 1, 4)) / 2
    soles = np.array([(a, s * c, 0.0) for a in along for c in across for s in (1.0, -1.0)]) @ rotation.T
    ground = terrain.heights(soles[:, 0] + x, soles[:, 1] + y)
    return float((ground - soles[:, 2]).max()) + SPAWN_GAP_M


def _quaternion(rotation: Array) -> Quat:
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return float(x), float(y), float(z), float(w)
