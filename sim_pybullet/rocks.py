"""Where rocks lie: scattered beside the planned route, which ground kept clear, and where asked."""

from __future__ import annotations

import math

import numpy as np

from executive.core.corridor import distance_m
from executive.core.rig import RoverCalibration
from executive.core.types import Segment
from sim_pybullet.scene import Rock
from sim_pybullet.terrain import Area, Terrain

RADII_M = (0.03, 0.16)
SIZE_EXPONENT = 2.5  # many small, few large: the number above r falls as r^-2.5
BURIED = (0.1, 0.7)  # share of the radius by which the centre lies below (or, negative, above) the ground
LANDER_CLEARANCE_M = 1.0
TRIES_PER_ROCK = 60


def scatter(
    count: int,
    area: Area,
    terrain: Terrain,
    route: tuple[Segment, ...],
    rover: RoverCalibration,
    rng: np.random.Generator,
) -> tuple[Rock, ...]:
    """Up to `count` rocks in `area`, fewer if it is full; none where the rover may drive or at the lander."""
    rocks: list[Rock] = []
    half_diagonal_m = math.hypot(rover.length_m, rover.width_m) / 2  # whichever way it stands
    for _ in range(count * TRIES_PER_ROCK):
        if len(rocks) == count:
            break
        x, y = (float(v) for v in rng.uniform(area.low_site_m, area.high_site_m))
        radius_m = _radius(float(rng.uniform()))
        sunk_m = float(rng.uniform(*BURIED)) * radius_m
        clear = all(distance_m(s, x, y) >= radius_m + half_diagonal_m + s.off_track_m for s in route)
        if clear and math.hypot(x, y) >= LANDER_CLEARANCE_M + radius_m:
            rocks.append(Rock((x, y, terrain.height(x, y) - sunk_m), radius_m))
    return tuple(rocks)


def _radius(share: float) -> float:
    """A radius from a power law between the limits, by inverse transform of `share` in 0..1."""
    low, high = (r**-SIZE_EXPONENT for r in RADII_M)
    return float((low + share * (high - low)) ** (-1 / SIZE_EXPONENT))


def obstacle(terrain: Terrain, x_m: float, y_m: float, radius_m: float, height_m: float) -> Rock:
    """A rock put at a place, its centre `height_m` above the ground."""
    return Rock((x_m, y_m, terrain.height(x_m, y_m) + height_m), radius_m)
