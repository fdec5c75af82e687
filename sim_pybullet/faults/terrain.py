"""Faults of the ground's grip: travel lost everywhere or in a patch, and sliding sideways."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Generic, TypeVar

from pydantic import Field

from executive.core.types import Vec2
from executive.core.units import Fraction, Length
from executive.record.events import Placed
from sim_pybullet.faults.base import Parameters, WorldFault, spec
from sim_pybullet.soil import Patch, Soil

if TYPE_CHECKING:
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

DRIVEN_M = 0.002  # travel of both belts together; after so much of it, the ground has shown what it does


class Slip(Parameters):
    """The share of all belt travel that is lost, whatever the ground."""

    slip: Annotated[Fraction, Field(gt=0, le=0.95, description="travel lost, of all")] = 0.4


class Drift(Parameters):
    """How far the rover slides to its left (negative: right) per way driven."""

    drift: Annotated[Fraction, Field(ge=-0.5, le=0.5, description="slide to the left, per way driven")] = 0.15


class Disc(Parameters):
    """Where the patch lies: how far along the path ahead of the rover, how far to its left, how wide."""

    ahead: Annotated[
        Length, Field(ge=0, le=5, description="its middle, along the planned path ahead of the rover")
    ] = 0.25
    aside: Annotated[Length, Field(ge=-1, le=1, description="its middle, to the left of the path")] = 0.0
    radius: Annotated[Length, Field(gt=0, le=3, description="of the patch")] = 0.35


class Smoothness(Disc):
    """A disc of ground with this friction, turned on with this share of the ideal yaw rate."""

    friction: Annotated[Fraction, Field(gt=0, le=1, description="of the ground in it")] = 0.2
    yaw_efficiency: Annotated[
        Fraction, Field(gt=0, le=1, description="yaw rate, of that of ideal tracks")
    ] = 0.25


class Depth(Disc):
    """A disc of ground in which this share of all belt travel is lost."""

    slip: Annotated[Fraction, Field(gt=0, le=1, description="travel lost, of all")] = 0.9


class SlipBurst(WorldFault[Slip]):
    """The ground gives way: a share of the belts' travel is lost, driving and turning alike."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.extra_slip = self.p.slip * level

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.driven_m > DRIVEN_M


class SideSlopeDrift(WorldFault[Drift]):
    """The rover slides sideways as it drives, more than the slope under it would make it."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.side_drift = self.p.drift * level

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.driven_m > DRIVEN_M


D = TypeVar("D", bound=Disc)


class _PatchFault(WorldFault[D], Generic[D]):
    """Lays a patch where the path leads at the onset; shows once the belts turned with the rover in it."""

    def __init__(self, parameters: D) -> None:
        super().__init__(parameters)
        self._at_site_m: Vec2 | None = None
        self._patch: Patch | None = None
        self._driven_m = self._driven_inside_m = 0.0

    def act(self, sim: WorldFaults, level: float) -> None:
        if self._patch is not None:
            sim.remove_soil(self._patch)
            self._patch = None
        if level == 0.0:
            return
        at = self._at_site_m = self._at_site_m or sim.ahead_on_path(self.p.ahead, self.p.aside)
        self._patch = Patch(at, self.p.radius, self.soil(sim.soil_at(at), level))
        sim.add_soil(self._patch)
        self._driven_m = sim.tally().driven_m

    def placed(self) -> tuple[Placed, ...]:
        return () if self._patch is None else (Placed("soil", *self._patch.at_site_m, self._patch.radius_m),)

    def soil(self, here: Soil, level: float) -> Soil:
        raise TypeError(f"{type(self).__name__} lays no soil")

    def step(self, sim: WorldFaults) -> None:
        driven_m, before_m = sim.tally().driven_m, self._driven_m
        self._driven_m = driven_m
        x, y, _ = sim.position()
        if self._at_site_m is not None:
            u, v = self._at_site_m
            inside = (x - u) ** 2 + (y - v) ** 2 < self.p.radius**2
            self._driven_inside_m += driven_m - before_m if inside else 0.0

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return self._driven_inside_m > DRIVEN_M


class LowFrictionPatch(_PatchFault[Smoothness]):
    """A patch ahead hardly holds: the rover turns less on it, slips uphill and slides down cross slopes."""

    def soil(self, here: Soil, level: float) -> Soil:
        friction, turning = min(here.friction, self.p.friction), self.p.yaw_efficiency
        slick = replace(here, friction=friction, cohesion_pa=0.0, side_slip=max(here.side_slip, 0.6))
        return replace(slick, yaw_efficiency=min(here.yaw_efficiency, turning))


class SandTrap(_PatchFault[Depth]):
    """Deep sand ahead in which the belts dig: most of their travel is lost, or all of it."""

    def soil(self, here: Soil, level: float) -> Soil:
        return replace(here, sinkage=self.p.slip * level)


SLIP_BURST = spec("slip_burst", SlipBurst, Slip, "slip_longitudinal", "terrain", graded=True)
SIDE_SLOPE_DRIFT = spec("side_slope_drift", SideSlopeDrift, Drift, "side_drift", "terrain", graded=True)
LOW_FRICTION_PATCH = spec("low_friction_patch", LowFrictionPatch, Smoothness, "slip_turning", "terrain")
SAND_TRAP = spec("sand_trap", SandTrap, Depth, "slip_longitudinal", "terrain", graded=True)
