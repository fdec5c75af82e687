"""Everything that a calibration solves for, as one vector, and what that vector says of the world.

The vector holds, in this order: the rig's parameters and the pointing errors (pan, tilt) of each look, both
in units of their prior sigmas; a step (position, rotation vector, in site) from the first guess of `plc` at
each station; bearing and inverse distance of each point, in which images are nearly linear near and far.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.types import Array
from perception.geometry.body import Transform
from perception.geometry.rotation import exp_map, skew


@dataclass(frozen=True, eq=False)
class Bearing:
    """A point at `origin_m + (axes[0] + a axes[1] + b axes[2]) / rho`; (a, b, rho) start at (0, 0, `rho`)."""

    origin_m: Array
    axes: Array
    rho: float

    @classmethod
    def towards(cls, origin_m: Array, point_m: Array) -> Bearing:
        ahead = point_m - origin_m
        distance = float(np.linalg.norm(ahead))
        _, _, frame = np.linalg.svd((ahead / distance)[None])
        return cls(origin_m, np.vstack([ahead / distance, frame[1:]]), 1 / distance)

    def place(self, abr: Array) -> tuple[Array, Array]:
        """The point (3,) for (a, b, rho), and its derivative (3, 3) by them."""
        along = np.array([1.0, abr[0], abr[1]]) @ self.axes
        J = np.stack([self.axes[1] / abr[2], self.axes[2] / abr[2], -along / abr[2] ** 2], axis=1)
        return self.origin_m + along / abr[2], J


@dataclass(frozen=True, eq=False)
class Unknowns:
    """How many of each there are, and where the vector starts from."""

    parameters: int
    looks: int
    stations: tuple[Transform, ...]
    points: tuple[Bearing, ...]

    @property
    def first_look(self) -> int:
        return self.parameters

    @property
    def first_station(self) -> int:
        return self.parameters + 2 * self.looks

    @property
    def first_point(self) -> int:
        return self.first_station + 6 * len(self.stations)

    @property
    def size(self) -> int:
        return self.first_point + 3 * len(self.points)

    def start(self) -> Array:
        x = np.zeros(self.size)
        x[self.first_point + 2 :: 3] = [point.rho for point in self.points]
        return x

    def pointing(self, x: Array) -> Array:
        """Pointing errors (looks, 2) in sigmas."""
        return x[self.first_look : self.first_station].reshape(-1, 2)

    def station(self, x: Array, index: int) -> Transform:
        """Pose of `plc` in site."""
        step, start = self.station_step(x, index), self.stations[index]
        return Transform(exp_map(step[3:]) @ start.rotation, start.position_m + step[:3])

    def station_step(self, x: Array, index: int) -> Array:
        first = self.first_station + 6 * index
        return x[first : first + 6]

    def point(self, x: Array, index: int) -> tuple[Array, Array]:
        """Position (3,) in site, and its derivative (3, 3) by the point's unknowns."""
        first = self.first_point + 3 * index
        return self.points[index].place(x[first : first + 3])


def turn_rate(turn_rad: Array) -> Array:
    """Left Jacobian of the rotation vector: exp(t + d) = exp(turn_rate(t) d) exp(t) for small d."""
    angle = float(np.linalg.norm(turn_rad))
    K = skew(turn_rad)
    if angle < 1e-6:
        return np.asarray(np.eye(3) + K / 2)
    first, second = (1 - math.cos(angle)) / angle**2, (angle - math.sin(angle)) / angle**3
    return np.asarray(np.eye(3) + first * K + second * (K @ K))
