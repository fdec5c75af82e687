"""The pan-tilt unit: it turns at a finite rate and misses its target a little, unseen by its encoders."""

from __future__ import annotations

import math

import numpy as np

from executive.clock import Clock
from executive.ports import Action
from executive.rig import HeadCalibration
from executive.types import HeadReading, Outcome, Reason
from sim_pybullet.actions import DeviceAction, ended
from sim_pybullet.joints import Axis, within


class SimHead:
    """The port, and the true angles for the cameras."""

    def __init__(self, calibration: HeadCalibration, clock: Clock, rng: np.random.Generator) -> None:
        self._calibration, self._clock, self._rng = calibration, clock, rng
        self._pan, self._tilt = Axis(0.0, calibration.speed_rad_s), Axis(0.0, calibration.speed_rad_s)
        self._error_rad = self._draw_error()
        self._action: DeviceAction[HeadReading] | None = None

    def _draw_error(self) -> tuple[float, float]:
        unit = self._rng.uniform(-1.0, 1.0, 2)
        return (
            float(unit[0]) * self._calibration.pan_accuracy_rad,
            float(unit[1]) * self._calibration.tilt_accuracy_rad,
        )

    @property
    def true_rad(self) -> tuple[float, float]:
        """Pan and tilt as they really are."""
        return self._pan.angle_rad + self._error_rad[0], self._tilt.angle_rad + self._error_rad[1]

    def point(self, pan_rad: float, tilt_rad: float) -> Action[HeadReading]:
        """Turn to these angles; a move under way ends CANCELLED."""
        limit = self._calibration.pan_limit_rad
        if not (within(pan_rad, (-limit, limit)) and within(tilt_rad, self._calibration.tilt_limits_rad)):
            detail = f"pan {math.degrees(pan_rad):.1f} deg, tilt {math.degrees(tilt_rad):.1f} deg"
            return ended(Outcome(Reason.OUT_OF_REACH, detail))
        self.stop()
        self._pan.target_rad, self._tilt.target_rad = pan_rad, tilt_rad
        if self._pan.arrived and self._tilt.arrived:  # no move, no new error
            return ended(Outcome(Reason.DONE, value=self.read()))
        self._error_rad = self._draw_error()
        self._action = DeviceAction(self.stop)
        return self._action

    def stop(self) -> None:
        """Stay where the head is."""
        self._pan.stop()
        self._tilt.stop()
        if self._action is not None:
            self._action.end(Outcome(Reason.CANCELLED))
            self._action = None

    def advance(self, tick_s: float) -> None:
        """Turn for one tick. Call before the clock counts it, `read` after."""
        if self._action is None:
            return
        self._pan.advance(tick_s)
        self._tilt.advance(tick_s)

    def settle(self) -> None:
        """End the move if both axes have arrived; the clock counts the tick already."""
        if self._action is not None and self._pan.arrived and self._tilt.arrived:
            action, self._action = self._action, None
            action.end(Outcome(Reason.DONE, value=self.read()))

    def read(self) -> HeadReading:
        """What the encoders say."""
        moving = self._action is not None
        return HeadReading(self._clock.now_s, self._pan.angle_rad, self._tilt.angle_rad, moving)
