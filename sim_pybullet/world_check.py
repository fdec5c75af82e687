"""Whether the ground of a scenario can be made and carries its route, told without making it."""

from __future__ import annotations

import math

from pydantic import BaseModel

from executive.config.backends import WorldProblem
from executive.config.source import Place
from executive.core.types import Segment, Vec2
from sim_pybullet.config import ProceduralConfig, TerrainConfig, WorldConfig
from sim_pybullet.elevation_model import Window, default_lander_m, read_model, window_on
from sim_pybullet.site import CELL_M, ROUTE_MARGIN_M
from sim_pybullet.terrain import TerrainError, points_outside

TERRAIN: Place = ("terrain",)


def world_problems(world: BaseModel, route: tuple[Segment, ...]) -> tuple[WorldProblem, ...]:
    """An elevation model that cannot be read, a window outside it, ground that ends before the route does."""
    if not isinstance(world, WorldConfig):
        return (WorldProblem((), f"got a world of type {type(world).__name__}, expected a WorldConfig"),)
    terrain = world.terrain
    place: Place = (*TERRAIN, "dem")
    try:
        if terrain.dem is not None:
            model = read_model(terrain.dem, terrain.cell)
            place = (*TERRAIN, "window")
            w = terrain.window
            window = window_on(model, Window(w.x, w.y, w.width) if w is not None else None)
        else:
            width = (terrain.procedural or ProceduralConfig()).width
            window = Window(0.0, 0.0, math.ceil(width / CELL_M) * CELL_M)
        low, high = _extent(terrain, window)
    except TerrainError as error:
        return (WorldProblem(place, str(error)),)
    outside = points_outside(low, high, route, ROUTE_MARGIN_M)
    return tuple(WorldProblem((), message, waypoint) for waypoint, message in outside)


def _extent(terrain: TerrainConfig, window: Window) -> tuple[Vec2, Vec2]:
    """The lower left and the upper right corner of the ground in `site`."""
    scale = terrain.scale if terrain.dem is not None else 1.0
    x, y = (terrain.lander.x, terrain.lander.y) if terrain.lander is not None else default_lander_m(window)
    width = window.width_m
    return (-x * scale, -y * scale), ((width - x) * scale, (width - y) * scale)
