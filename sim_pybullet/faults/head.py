"""Faults of the pan-tilt unit and of the lander that it stands on; most of them its encoders cannot see."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from executive.core.units import Angle, Fraction, Length
from sim_pybullet.faults.base import Nothing, Parameters, WorldFault, spec

if TYPE_CHECKING:
    from sim_pybullet.head_axis import HeadAxis
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

UNSEEN_RAD = math.radians(0.005)  # half a pixel's part; from here on the head has pointed elsewhere

Small = Annotated[Angle, Field(ge=-math.radians(10), le=math.radians(10))]


class Offset(Parameters):
    """By how much the head points beyond what its encoders say: left and down positive."""

    pan: Annotated[Small, Field(description="beyond the encoder, left positive")] = math.radians(0.4)
    tilt: Annotated[Small, Field(description="beyond the encoder, down positive")] = 0.0


class Play(Parameters):
    """The play between gear and head, of both axes."""

    play: Annotated[
        Angle, Field(gt=0, le=math.radians(5), description="between gear and head, of both axes")
    ] = math.radians(0.3)


class Slowness(Parameters):
    """How fast both axes turn compared with a sound head."""

    factor: Annotated[Fraction, Field(gt=0, lt=1, description="speed, of that of a sound head")] = 0.2


class Loss(Parameters):
    """The share of every motion to the left, or down, that does not reach the head."""

    share: Annotated[Fraction, Field(gt=0, le=1, description="of every motion to the left or down")] = 0.05


class Settling(Parameters):
    """How far the lander sinks, leans over towards a direction, and turns to the left."""

    sinks: Annotated[Length, Field(ge=0, le=0.2, description="how far")] = 0.01
    leans: Annotated[Angle, Field(ge=0, le=math.radians(5), description="how far")] = math.radians(0.3)
    towards: Annotated[Angle, Field(description="direction that it leans to, from site x, left positive")] = (
        0.0
    )
    twists: Annotated[
        Angle,
        Field(ge=-math.radians(5), le=math.radians(5), description="how far, left positive"),
    ] = math.radians(0.2)


def _axes(sim: WorldFaults) -> tuple[HeadAxis, HeadAxis]:
    return sim.world.head.pan, sim.world.head.tilt


class PanLocked(WorldFault[Nothing]):
    """The head no longer pans, as its encoder sees; a move that needs to ends DEVICE."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.head.pan.locked = level > 0.0

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return sim.world.head.moving and not sim.world.head.pan.arrived


class TiltLocked(WorldFault[Nothing]):
    """The head no longer tilts, as its encoder sees; a move that needs to ends DEVICE."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.head.tilt.locked = level > 0.0

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return sim.world.head.moving and not sim.world.head.tilt.arrived


class HeadSlow(WorldFault[Slowness]):
    """The head turns more slowly than it should, as its encoders see."""

    def act(self, sim: WorldFaults, level: float) -> None:
        for axis in _axes(sim):
            axis.rate_factor = 1.0 - (1.0 - self.p.factor) * level

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return sim.world.head.moving


class _Mispointing:
    """Shows once a frame was exposed while the head pointed elsewhere than its encoders say."""

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.frames > 0 and any(abs(axis.unseen_rad) > UNSEEN_RAD for axis in _axes(sim))


class HeadOffset(_Mispointing, WorldFault[Offset]):
    """The head points beside where its encoders say, and every fix is off by that."""

    def act(self, sim: WorldFaults, level: float) -> None:
        for axis, bias_rad in zip(_axes(sim), (self.p.pan, self.p.tilt), strict=True):
            axis.bias_rad = bias_rad * level


class HeadBacklash(_Mispointing, WorldFault[Play]):
    """Between gear and head there is play: the head lags its encoders, on either side by turns."""

    def act(self, sim: WorldFaults, level: float) -> None:
        for axis in _axes(sim):
            axis.play_rad = self.p.play * level


class HeadStepLoss(_Mispointing, WorldFault[Loss]):
    """The head's motors lose steps going left and down, counted all the same; the error adds up by moves."""

    def act(self, sim: WorldFaults, level: float) -> None:
        for axis in _axes(sim):
            axis.lost_share = self.p.share if level else 0.0
            axis.lost_rad = axis.lost_rad if level else 0.0  # once repaired, the head is referenced anew


class LanderSettling(WorldFault[Settling]):
    """The lander sinks and leans, and with it the frame that every fix is measured in; it stays so."""

    def act(self, sim: WorldFaults, level: float) -> None:
        twist_rad = self.p.twists * level
        lean_rad, c, s = self.p.leans * level, math.cos(self.p.towards), math.sin(self.p.towards)
        sim.see(
            lander_shift_m=(0.0, 0.0, -self.p.sinks * level),
            lander_turn_rad=(
                -s * lean_rad,
                c * lean_rad,
                twist_rad,
            ),  # about the axis across: over, not round
        )

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.frames > 0


MISALIGNED = "head_misaligned"
PAN_LOCKED = spec("pan_locked", PanLocked, Nothing, "lost_rover", "head")
TILT_LOCKED = spec("tilt_locked", TiltLocked, Nothing, "lost_rover", "head")
HEAD_SLOW = spec("head_slow", HeadSlow, Slowness, None, "head", graded=True)
HEAD_OFFSET = spec("head_offset", HeadOffset, Offset, MISALIGNED, "head", graded=True)
HEAD_BACKLASH = spec("head_backlash", HeadBacklash, Play, MISALIGNED, "head", graded=True)
HEAD_STEP_LOSS = spec("head_step_loss", HeadStepLoss, Loss, MISALIGNED, "head")
LANDER_SETTLING = spec(
    "lander_settling", LanderSettling, Settling, MISALIGNED, "head", graded=True, lasting=True
)
