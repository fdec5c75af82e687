"""Faults of the ground's shape: stones and rises that ground did not know of, lying still or moving."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Generic, TypeVar

from pydantic import Field

from executive.core.units import Length, Speed
from executive.record.events import Placed
from sim_pybullet.faults.base import Parameters, WorldFault, spec

if TYPE_CHECKING:
    from sim_pybullet.scene import Rock
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

UNLOADED = 0.85  # of the weight: with less than that on the tracks, the belly bears some
RISING_M_S = 0.001


class RockAhead(Parameters):
    """How far along the planned path ahead of the rover; the rock is a sphere, its centre in the ground."""

    ahead: Annotated[
        Length, Field(ge=0.25, le=5, description="its middle, along the planned path ahead of the rover")
    ] = 0.5
    aside: Annotated[Length, Field(ge=-0.3, le=0.3, description="its middle, to the left of the path")] = 0.0
    radius: Annotated[Length, Field(gt=0, le=0.5, description="of the sphere")] = 0.10


class RollingRock(Parameters):
    """A rock that rolls across the planned path, from one place beside it (left positive) to another."""

    ahead: Annotated[
        Length,
        Field(ge=0.25, le=5, description="where it crosses, along the planned path ahead of the rover"),
    ] = 0.5
    from_aside: Annotated[
        Length, Field(ge=-2, le=2, description="where it starts, to the left of the path")
    ] = 0.6
    to_aside: Annotated[
        Length, Field(ge=-2, le=2, description="where it comes to rest, to the left of the path")
    ] = 0.0
    radius: Annotated[Length, Field(gt=0, le=0.5, description="of the sphere")] = 0.10
    speed: Annotated[Speed, Field(gt=0, le=0.1, description="how fast it rolls")] = 0.005


class BellyStone(Parameters):
    """A stone between the tracks, and how high it comes to stand above their soles; the belly is 20 mm up."""

    height: Annotated[
        Length, Field(gt=0.02, le=0.05, description="how far it comes to stand above the soles of the tracks")
    ] = 0.03
    radius: Annotated[Length, Field(ge=0.025, le=0.042, description="of the sphere")] = 0.04


class Rise(Parameters):
    """How high the ground rises where the model has none, how wide, and where along the planned path."""

    ahead: Annotated[
        Length, Field(ge=0, le=5, description="its top, along the planned path ahead of the rover")
    ] = 0.5
    aside: Annotated[Length, Field(ge=-1, le=1, description="its top, to the left of the path")] = 0.0
    height: Annotated[Length, Field(gt=0, le=0.2, description="of its top above the model")] = 0.04
    radius: Annotated[Length, Field(gt=0.05, le=2, description="of its foot")] = 0.35


R = TypeVar("R", bound=Parameters)


class _RockFault(WorldFault[R], Generic[R]):
    """Puts one rock somewhere; shows once the rover touches it or a frame missed a marker for it."""

    kind = "rock"

    def __init__(self, parameters: R) -> None:
        super().__init__(parameters)
        self.rock: Rock | None = None
        self._frames = 0

    def placed(self) -> tuple[Placed, ...]:
        if self.rock is None:
            return ()
        x, y, _ = self.rock.centre_site_m
        return (Placed(self.kind, x, y, self.drawn_m(self.rock)),)

    def drawn_m(self, rock: Rock) -> float:
        """How large it is on a map."""
        return rock.radius_m

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        if self.rock is None:
            return False
        seen, self._frames = self._frames, done.frames
        return sim.touches_rover(self.rock) or (done.frames > seen and sim.hides(self.rock))


class RockOnPath(_RockFault[RockAhead]):
    """A rock that ground did not know lies on the path ahead of the rover, and stays there."""

    def act(self, sim: WorldFaults, level: float) -> None:
        if level > 0.0 and self.rock is None:
            p = self.p
            self.rock = sim.add_obstacle(*sim.ahead_on_path(p.ahead, p.aside), p.radius)


class MovingRock(_RockFault[RollingRock]):
    """A rock beside the path rolls to another place, onto the path or away from it, and stays there."""

    def act(self, sim: WorldFaults, level: float) -> None:
        if level > 0.0 and self.rock is None:
            start = sim.ahead_on_path(self.p.ahead, self.p.from_aside)
            self._end = sim.ahead_on_path(self.p.ahead, self.p.to_aside)
            self.rock = sim.add_obstacle(*start, self.p.radius)

    def step(self, sim: WorldFaults) -> None:
        """Roll on for a tick; the rover is too heavy to be pushed."""
        if self.rock is None or sim.touches_rover(self.rock):
            return
        x, y, _ = self.rock.centre_site_m
        left_m = math.dist((x, y), self._end)
        if left_m < 1e-6:
            return
        share = min(1.0, self.p.speed * sim.world.clock.tick_s / left_m)
        x, y = x + share * (self._end[0] - x), y + share * (self._end[1] - y)
        self.rock = sim.move_rock(self.rock, x, y, sim.world.terrain.height(x, y))


class CabinGrounding(_RockFault[BellyStone]):
    """The tracks dig in until the belly rests on a stone: they bear less of the weight, and push less."""

    def act(self, sim: WorldFaults, level: float) -> None:
        if level == 0.0 and self.rock is not None:
            sim.remove_rock(self.rock)
            self.rock = None
        elif level > 0.0 and self.rock is None:
            x, y, z = (float(v) for v in sim.position())
            self._ground_m = z
            self.rock = sim.add_obstacle(
                x, y, self.p.radius, z - sim.world.terrain.height(x, y) - self.p.radius
            )

    def step(self, sim: WorldFaults) -> None:
        """Come up by a tick's worth."""
        if self.rock is not None:
            x, y, z = self.rock.centre_site_m
            top_m = self._ground_m + self.p.height * self.level - self.p.radius
            if z < top_m:
                rise_m = RISING_M_S * sim.world.clock.tick_s
                self.rock = sim.move_rock(self.rock, x, y, min(top_m, z + rise_m))

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return sum(sim.world.body.loads()) < UNLOADED * sim.world.weight_n


class WrongElevationModel(_RockFault[Rise]):
    """The ground ahead is higher than the model of it says: a smooth rise, the cap of a large sphere."""

    kind = "rise"

    def drawn_m(self, rock: Rock) -> float:
        return self.p.radius

    def act(self, sim: WorldFaults, level: float) -> None:
        if self.rock is None and level > 0.0:
            at = sim.ahead_on_path(self.p.ahead, self.p.aside)
            self.rock = sim.add_obstacle(*at, self._sphere_m, -self._sphere_m)
            self._ground_m = sim.world.terrain.height(*at)
        if self.rock is not None and level > 0.0:
            x, y, _ = self.rock.centre_site_m
            top_m = self._ground_m + self.p.height * level
            self.rock = sim.move_rock(self.rock, x, y, top_m - self._sphere_m)
        elif self.rock is not None:
            sim.remove_rock(self.rock)
            self.rock = None

    @property
    def _sphere_m(self) -> float:
        """Radius of the sphere whose cap is as high and as wide as the rise."""
        return (self.p.radius**2 + self.p.height**2) / (2 * self.p.height)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return self.rock is not None and sim.touches_rover(self.rock)


STUCK = "stuck_on_obstacle"
ROCK_ON_PATH = spec("rock_on_path", RockOnPath, RockAhead, STUCK, "terrain", lasting=True)
MOVING_ROCK = spec("moving_rock", MovingRock, RollingRock, STUCK, "terrain", lasting=True)
CABIN_GROUNDING = spec("cabin_grounding", CabinGrounding, BellyStone, STUCK, "terrain", graded=True)
WRONG_ELEVATION_MODEL = spec(
    "wrong_elevation_model", WrongElevationModel, Rise, "tilt_risk", "terrain", graded=True
)
