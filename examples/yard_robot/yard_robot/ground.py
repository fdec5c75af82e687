"""What the ground makes of the treads' travel: slip, and how well a skid-steered robot turns on it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from longarm import Segment

from yard_robot.config import GroundConfig

_MARGIN_M = 1.0  # of the ground that is strewn with patches, around the route
_WAVES = 12


@dataclass(frozen=True)
class Patch:
    """A round patch of soft ground."""

    x_m: float
    y_m: float
    radius_m: float

    def holds(self, x_m: float, y_m: float) -> bool:
        """Whether this place lies in it."""
        return math.hypot(x_m - self.x_m, y_m - self.y_m) < self.radius_m


class Ground:
    """Soft patches, and slip that differs a little from place to place, smoothly over half a metre or so."""

    def __init__(self, config: GroundConfig, route: tuple[Segment, ...], rng: np.random.Generator) -> None:
        self._config = config
        self.patches = _strewn(config, route, rng)
        self._waves = rng.normal(0.0, 2.0, (_WAVES, 2))
        self._phases = rng.uniform(0.0, 2 * math.pi, _WAVES)

    def slip(self, x_m: float, y_m: float) -> float:
        """Share of the treads' travel that is lost here; may be a little negative, as encoders differ."""
        waves = np.sin(self._waves @ (x_m, y_m) + self._phases)
        scatter = self._config.scatter * float(waves.sum()) * math.sqrt(2 / _WAVES)
        return scatter + (self._config.slip_in_patches if self._soft(x_m, y_m) else 0.0)

    def turning(self, x_m: float, y_m: float) -> float:
        """True rotation here per that which the treads alone would give."""
        return self._config.turning_in_patches if self._soft(x_m, y_m) else self._config.turning

    def _soft(self, x_m: float, y_m: float) -> bool:
        return any(patch.holds(x_m, y_m) for patch in self.patches)


def area_of(route: tuple[Segment, ...]) -> tuple[tuple[float, float], tuple[float, float]]:
    """The rectangle that holds the route with a margin: its lowest and its highest x and y [m]."""
    points = [point for segment in route for point in (segment.start, segment.end)]
    x, y = [p.x_m for p in points], [p.y_m for p in points]
    return (min(x) - _MARGIN_M, min(y) - _MARGIN_M), (max(x) + _MARGIN_M, max(y) + _MARGIN_M)


def _strewn(config: GroundConfig, route: tuple[Segment, ...], rng: np.random.Generator) -> tuple[Patch, ...]:
    """Patches somewhere in the area of the route."""
    places = rng.uniform(*area_of(route), (config.patches, 2)).tolist()
    return tuple(Patch(x, y, config.patch_radius) for x, y in places)
