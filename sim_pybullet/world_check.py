"""Whether the ground of a scenario can be made and carries its route, without making it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pydantic import BaseModel

from executive.config.backends import WorldProblem
from executive.config.source import Place
from executive.core.corridor import distance_m
from executive.core.rig import RoverCalibration
from executive.core.types import Segment, Vec2
from sim_pybullet.config import ObstacleConfig, ProceduralConfig, TerrainConfig, WorldConfig
from sim_pybullet.elevation_model import Window, default_lander_m, read_model, window_on
from sim_pybullet.terrain import CELL_M, ROUTE_MARGIN_M, TerrainError, points_outside

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
    problems = [WorldProblem((), message, waypoint) for waypoint, message in outside]
    return (*problems, *_in_the_way(world.obstacles, route))


def _in_the_way(obstacles: tuple[ObstacleConfig, ...], route: tuple[Segment, ...]) -> Iterator[WorldProblem]:
    """Obstacles that a rover on its line drives into, each at the way-point that it drives to.

    A warning, since what ground has not seen may be tried so; but no rover stands inside of a rock.
    """
    half_m = RoverCalibration().width_m / 2
    for segment in route:
        for number, rock in enumerate(obstacles):
            radius_m = _radius_at_ground_m(rock)
            spare_m = distance_m(segment, rock.at.x, rock.at.y) - radius_m - half_m
            where = f"obstacle {number} at ({rock.at.x:.4g} m, {rock.at.y:.4g} m)"
            if math.hypot(segment.end.x_m - rock.at.x, segment.end.y_m - rock.at.y) < radius_m:
                message = f"got a way-point inside of {where}, which has a radius of {radius_m:.2f} m"
                yield WorldProblem((), message, segment.index + 1)
            elif radius_m > 0.0 and spare_m < 0.0:
                missing = f"{-spare_m:.2f} m too near for half the rover's width of {half_m:.3g} m"
                message = f"the way here leads through {where}: {missing}"
                yield WorldProblem((), message, segment.index + 1, warning=True)


def _radius_at_ground_m(rock: ObstacleConfig) -> float:
    """How wide a sphere is where it is widest above the ground [m]; 0 if it is buried."""
    if rock.height <= -rock.radius:
        return 0.0
    return rock.radius if rock.height >= 0.0 else math.sqrt(rock.radius**2 - rock.height**2)


def _extent(terrain: TerrainConfig, window: Window) -> tuple[Vec2, Vec2]:
    """The lower left and the upper right corner of the ground in `site`."""
    scale = terrain.scale if terrain.dem is not None else 1.0
    x, y = (terrain.lander.x, terrain.lander.y) if terrain.lander is not None else default_lander_m(window)
    width = window.width_m
    return (-x * scale, -y * scale), ((width - x) * scale, (width - y) * scale)
