"""Faults of the track motors. Their encoders see them: they sit on the motors' shafts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Generic, Literal, TypeVar

from pydantic import Field

from executive.core.units import Duration, Fraction
from sim_pybullet.faults.base import Parameters, WorldFault, spec

if TYPE_CHECKING:
    from sim_pybullet.motor import Motor
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

ASTRAY_M = 0.0005  # turned otherwise than commanded by so much, a motor's fault has shown


class Side(Parameters):
    """Which track."""

    side: Annotated[Literal["left", "right"], Field(description="which track")]

    @property
    def index(self) -> int:
        return ("left", "right").index(self.side)


class Weakness(Side):
    """Which track, and how fast its motor turns compared with what is commanded."""

    factor: Annotated[Fraction, Field(gt=0, lt=1, description="speed, of the commanded one")] = 0.6


class Runaway(Side):
    """Which track, how long its motor keeps turning after a drive, and how fast compared with the command."""

    lasts: Annotated[Duration, Field(gt=0, le=120, description="how long it keeps turning after a drive")] = (
        15.0
    )
    factor: Annotated[Fraction, Field(ge=1, le=3, description="speed, of the commanded one")] = 1.0


S = TypeVar("S", bound=Side)


class _MotorFault(WorldFault[S], Generic[S]):
    def act(self, sim: WorldFaults, level: float) -> None:
        self.alter(sim.world.tracks.motors[self.p.index], level)

    def alter(self, motor: Motor, level: float) -> None:
        raise TypeError(f"{type(self).__name__} alters nothing")

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.astray_m[self.p.index] > ASTRAY_M


class MotorDead(_MotorFault[Side]):
    """A motor gets no power: its belt stands, and a drive that needs it never ends."""

    def alter(self, motor: Motor, level: float) -> None:
        motor.powered = level == 0.0


class TrackWeak(_MotorFault[Weakness]):
    """One motor turns slower than commanded, as its encoder sees: the rover swerves until it catches up."""

    def alter(self, motor: Motor, level: float) -> None:
        motor.speed_factor = 1.0 - (1.0 - self.p.factor) * level


class MotorRunaway(_MotorFault[Runaway]):
    """A motor keeps turning when its drive has ended or was stopped, as with a relay that sticks."""

    def alter(self, motor: Motor, level: float) -> None:
        motor.runs_on_s = self.p.lasts if level else 0.0
        motor.speed_factor = self.p.factor if level else 1.0


class MotorReversed(_MotorFault[Side]):
    """A motor turns the wrong way, its counts run away from what was commanded, and a drive never ends."""

    def alter(self, motor: Motor, level: float) -> None:
        motor.reversed = level > 0.0


class TrackJam(_MotorFault[Side]):
    """Something jams a belt: its motor stalls, its current rises to the limit, the drive ends BLOCKED."""

    def alter(self, motor: Motor, level: float) -> None:
        motor.jammed = level > 0.0


MOTOR_DEAD = spec("motor_dead", MotorDead, Side, "track_asymmetry", "tracks")
TRACK_WEAK = spec("track_weak", TrackWeak, Weakness, "track_asymmetry", "tracks", graded=True)
MOTOR_RUNAWAY = spec("motor_runaway", MotorRunaway, Runaway, "track_asymmetry", "tracks")
MOTOR_REVERSED = spec("motor_reversed", MotorReversed, Side, "track_asymmetry", "tracks")
TRACK_JAM = spec("track_jam", TrackJam, Side, "stuck_on_obstacle", "tracks")
