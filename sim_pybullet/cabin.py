"""The payload cabin's two joints: driven at a finite rate, held by Bullet, read with noise."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from executive.core.clock import Clock
from executive.core.ports import Action
from executive.core.rig import CabinCalibration
from executive.core.types import CabinReading, Outcome, Reason
from sim_pybullet.actions import DeviceAction, PerTick, ended
from sim_pybullet.joints import Axis, within

LAG_LIMIT_RAD = math.radians(3.0)  # a joint this far behind its motor has met something


class SimCabin:
    """The port, and the joint targets for the physics. `true_angles` reads arm and cabin from the physics."""

    def __init__(
        self,
        calibration: CabinCalibration,
        clock: Clock,
        rng: np.random.Generator,
        true_angles: Callable[[], tuple[float, float]],
    ) -> None:
        self._calibration, self._clock, self._rng = calibration, clock, rng
        self._true_angles = true_angles
        self._arm, self._cabin = Axis(0.0, calibration.speed_rad_s), Axis(0.0, calibration.speed_rad_s)
        self._seized_arm_rad: float | None = None
        self._seized_against_arm_rad: float | None = None
        self._action: DeviceAction[CabinReading] | None = None
        self._reading = PerTick(self._measure, lambda: clock.ticks)

    @property
    def moving(self) -> bool:
        """Whether a move is under way."""
        return self._action is not None

    @property
    def targets_rad(self) -> tuple[float, float]:
        """Where the joints are held now: arm, cabin. A seized one stays behind its motor."""
        arm_rad, cabin_rad = self._motors_rad
        if self._seized_arm_rad is not None:
            arm_rad, cabin_rad = self._seized_arm_rad, cabin_rad - arm_rad + self._seized_arm_rad
        if self._seized_against_arm_rad is not None:
            cabin_rad = arm_rad - self._seized_against_arm_rad
        return arm_rad, cabin_rad

    @property
    def behind_rad(self) -> float:
        """How far the joints are behind their motors, the worse of the two."""
        return max(abs(m - a) for m, a in zip(self._motors_rad, self._true_angles(), strict=True))

    @property
    def _motors_rad(self) -> tuple[float, float]:
        return self._arm.angle_rad, self._cabin.angle_rad

    def seize_arm(self, seized: bool) -> None:
        """Let the arm's joint seize where it stands, or come free."""
        self._seized_arm_rad = self._arm.angle_rad if seized else None

    def seize_cabin(self, seized: bool) -> None:
        """Let the cabin's joint, which turns it against the arm, seize where it stands, or come free."""
        self._seized_against_arm_rad = self._arm.angle_rad - self._cabin.angle_rad if seized else None

    def move(self, arm_rad: float, cabin_rad: float) -> Action[CabinReading]:
        """Move both joints; a move under way ends CANCELLED."""
        limits = self._calibration
        if not (within(arm_rad, limits.arm_limits_rad) and within(cabin_rad, limits.cabin_limits_rad)):
            detail = f"arm {math.degrees(arm_rad):.1f} deg, cabin {math.degrees(cabin_rad):.1f} deg"
            return ended(Outcome(Reason.OUT_OF_REACH, detail))
        self.stop()
        self._arm.target_rad, self._cabin.target_rad = arm_rad, cabin_rad
        self._action = DeviceAction(self.stop)
        return self._action

    def stop(self) -> None:
        """Stay where the joints are."""
        self._arm.stop()
        self._cabin.stop()
        if self._action is not None:
            self._action.end(Outcome(Reason.CANCELLED))
            self._action = None

    def advance(self, tick_s: float) -> None:
        """Drive the motors for one tick; the physics follows within it."""
        if self._action is not None:
            self._arm.advance(tick_s)
            self._cabin.advance(tick_s)

    def settle(self) -> None:
        """End the move where both motors have arrived, or where a joint does not follow."""
        if self._action is None:
            return
        lag = self.behind_rad
        if lag > LAG_LIMIT_RAD:
            self._end(Reason.BLOCKED, f"a joint lags {math.degrees(lag):.1f} deg behind its motor")
        elif self._arm.arrived and self._cabin.arrived:
            self._end(Reason.DONE)

    def _end(self, reason: Reason, detail: str = "") -> None:
        action, self._action = self._action, None
        self._arm.stop()
        self._cabin.stop()
        if action is not None:
            action.end(Outcome(reason, detail, self._measure()))

    def read(self) -> CabinReading:
        """The joint sensors, with noise."""
        return self._reading.read()

    def _measure(self) -> CabinReading:
        noise = self._rng.standard_normal(2) * self._calibration.joint_sigma_rad
        arm, cabin = self._true_angles()
        return CabinReading(self._clock.now_s, arm + float(noise[0]), cabin + float(noise[1]), self.moving)
