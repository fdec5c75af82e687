"""Faults of the tether and its spool."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from executive.core.units import (
    Angle,
    Force,
    Fraction,
    Length,
)
from executive.record.events import Placed
from sim_pybullet.faults.base import Nothing, Parameters, WorldFault, spec
from sim_pybullet.lay import Bend

if TYPE_CHECKING:
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

PULL_N = 0.15  # three times the drag of a free spool
DRIVEN_M = 0.01
SNAG_DRAWN_M = 0.05  # how large the map shows what the tether is caught at


class Snag(Parameters):
    """Where the tether is caught, how hard it pulls once stretched by `give`, what the spool feels of it."""

    behind: Annotated[Length, Field(gt=0, le=20, description="where it is caught, behind the rover")] = 0.4
    pull: Annotated[Force, Field(gt=0, le=50, description="how hard it pulls once stretched by `give`")] = 4.0
    give: Annotated[Length, Field(gt=0, le=1, description="how far it stretches for `pull`")] = 0.1
    felt: Annotated[
        Fraction, Field(ge=0, le=1, description="share of the pull that the sensor at the spool feels")
    ] = 0.5


class Wrap(Parameters):
    """Where the tether lies round a rock, how far round, and the friction between them."""

    behind: Annotated[Length, Field(gt=0, le=20, description="where the rock is, behind the rover")] = 0.4
    angle: Annotated[
        Angle, Field(gt=0, le=math.radians(1080), description="how far the tether lies round it")
    ] = math.radians(450)
    friction: Annotated[Fraction, Field(gt=0, le=1, description="between rock and tether")] = 0.5


class Shortage(Parameters):
    """How much tether is left on the spool."""

    left: Annotated[Length, Field(ge=0, le=100, description="tether left on the spool")] = 0.1


class Loop(Parameters):
    """How much more tether lies out than the way takes."""

    loop: Annotated[Length, Field(gt=0, le=20, description="tether out beyond what the way takes")] = 0.5


class _Pulling:
    """Shows once the tether pulls at the rover harder than a free spool lets it."""

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return sim.world.tether.tension_n > PULL_N


class _Bending(_Pulling):
    """The same, with the place where the tether bends."""

    bend: Bend | None = None

    def placed(self) -> tuple[Placed, ...]:
        return () if self.bend is None else (Placed("snag", *self.bend.at_site_m[:2], SNAG_DRAWN_M),)


class TetherSnag(_Bending, WorldFault[Snag]):
    """The tether is caught behind the rover: it pays out no more and pulls the harder the farther it goes."""

    def act(self, sim: WorldFaults, level: float) -> None:
        at = sim.on_the_tether(self.p.behind)
        stiffness_n_m, tether = self.p.pull / self.p.give, sim.world.tether
        self.bend = Bend(at, 1.0, True, stiffness_n_m, self.p.felt) if level else None
        tether.bend = self.bend
        tether.length_m = max(tether.length_m, tether.way_m(sim.world.anchor()))  # no pull from nowhere
        sim.world.wake()


class TetherCapstan(_Bending, WorldFault[Wrap]):
    """The tether drags round a rock: the pull grows by e^(friction x angle), unfelt at the spool."""

    def act(self, sim: WorldFaults, level: float) -> None:
        capstan = math.exp(self.p.friction * self.p.angle * level)
        tether = sim.world.tether
        at = tether.bend.at_site_m if tether.bend else sim.on_the_tether(self.p.behind)
        self.bend = Bend(at, capstan) if level else None
        tether.bend = self.bend
        sim.world.wake()


class SpoolJam(_Pulling, WorldFault[Nothing]):
    """The spool turns no more: what lies out is all that there is, and it hardly stretches."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.tether.jammed = level > 0.0
        sim.world.wake()


class TetherShort(_Pulling, WorldFault[Shortage]):
    """The spool holds less tether than the plan reckons with; at its end the rover is held."""

    def act(self, sim: WorldFaults, level: float) -> None:
        tether, rover = sim.world.tether, sim.world.rig.rover
        tether.limit_m = tether.length_m + self.p.left if level else rover.tether_length_m
        sim.world.wake()


class TetherSlack(WorldFault[Loop]):
    """The spool has overrun: a loose loop lies on the ground, more is out than needed and nothing pulls."""

    def act(self, sim: WorldFaults, level: float) -> None:
        tether = sim.world.tether
        more_m = self.p.loop if level else -self.p.loop
        tether.length_m = max(tether.length_m + more_m, tether.way_m(sim.world.anchor()))
        sim.world.wake()

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        tether = sim.world.tether
        loose = tether.length_m - tether.way_m(sim.world.anchor()) > self.p.loop / 2
        return loose and done.driven_m > DRIVEN_M


SNAG = "tether_snag"
TETHER_SNAG = spec("tether_snag", TetherSnag, Snag, SNAG, "tether")
TETHER_CAPSTAN = spec("tether_capstan", TetherCapstan, Wrap, SNAG, "tether", graded=True)
SPOOL_JAM = spec("spool_jam", SpoolJam, Nothing, SNAG, "tether")
TETHER_SHORT = spec("tether_short", TetherShort, Shortage, SNAG, "tether")
TETHER_SLACK = spec("tether_slack", TetherSlack, Loop, None, "tether")
