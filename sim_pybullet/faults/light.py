"""Faults of the light: the sun moves on, clouds pass, something glares."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from executive.core.units import Angle, Duration, Fraction
from sim_pybullet.faults.base import Parameters, WorldFault, spec
from sim_pybullet.faults.cameras import CameraChoice

if TYPE_CHECKING:
    from sim_pybullet.seeing import Lens
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

SUN_STEP_RAD = math.radians(0.5)  # the full tier lights its ground anew at each step
Half = Annotated[Angle, Field(ge=-math.pi, le=math.pi)]


class SunPath(Parameters):
    """How far the sun has moved at full severity; with the profile `ramp`, over that time."""

    elevation: Annotated[Half, Field(description="how much higher it stands at full severity")] = (
        math.radians(-20)
    )
    azimuth: Annotated[
        Half, Field(description="how far it has gone round at full severity, left positive")
    ] = math.radians(40)


class Clouds(Parameters):
    """The share of the light that the thickest cloud takes, and the time from one to the next."""

    depth: Annotated[
        Fraction, Field(gt=0, le=0.95, description="light that the thickest cloud takes, of all")
    ] = 0.6
    period: Annotated[Duration, Field(ge=5, le=3600, description="from one cloud to the next")] = 40.0


class Veil(CameraChoice):
    """Which camera, and its stray light over that from sunlit ground."""

    veil: Annotated[
        Fraction,
        Field(
            gt=0,
            le=20,
            description="stray light, of that from sunlit ground, which saturates from 1.5 on",
        ),
    ] = 2.5


class SunMoving(WorldFault[SunPath]):
    """The sun moves on: shadows turn, the ground gets brighter or darker than the exposure was set for."""

    def act(self, sim: WorldFaults, level: float) -> None:
        steps = math.ceil(max(abs(self.p.elevation), abs(self.p.azimuth)) / SUN_STEP_RAD)
        share = math.floor(level * steps + 1e-9) / max(steps, 1)
        sim.move_sun(self.p.elevation * share, self.p.azimuth * share)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.frames > 0 and sim.sun_has_moved()


class Cloud(WorldFault[Clouds]):
    """Broken clouds pass before the sun: the light changes from frame to frame."""

    def __init__(self, parameters: Clouds) -> None:
        super().__init__(parameters)
        self._began_s = 0.0

    def act(self, sim: WorldFaults, level: float) -> None:
        if sim.world.seeing.clouds == 1.0:
            self._began_s = sim.world.clock.now_s
        self._shade(sim)

    def step(self, sim: WorldFaults) -> None:
        self._shade(sim)

    def _shade(self, sim: WorldFaults) -> None:
        phase = 2 * math.pi * (sim.world.clock.now_s - self._began_s) / self.p.period
        sim.see(clouds=1.0 - self.p.depth * self.level * (1 - math.cos(phase)) / 2)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.frames > 0 and sim.world.seeing.clouds < 1.0


class Glare(WorldFault[Veil]):
    """Stray light veils the images: noise grows, and where the wells are full nothing shows any more."""

    def act(self, sim: WorldFaults, level: float) -> None:
        left, right = (
            self._veiled(camera, lens, level) for camera, lens in enumerate(sim.world.seeing.lenses)
        )
        sim.see(lenses=(left, right))

    def _veiled(self, camera: int, lens: Lens, level: float) -> Lens:
        return replace(lens, veil=self.p.veil * level) if self.p.has(camera) else lens

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.frames > 0


CHANGE = "illumination_change"
SUN_MOVING = spec("sun_moving", SunMoving, SunPath, CHANGE, "light", graded=True)
CLOUD = spec("cloud", Cloud, Clouds, CHANGE, "light", graded=True)
GLARE = spec("glare", Glare, Veil, CHANGE, "light", graded=True)
