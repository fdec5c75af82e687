"""The pan-tilt unit: it turns at a finite rate and misses its target a little, unseen by its encoders."""

from __future__ import annotations

import math

import numpy as np

from executive.core.clock import Clock
from executive.core.ports import Action
from executive.core.rig import HeadCalibration
from executive.core.types import HeadReading, Outcome, Reason
from sim_pybullet.actions import DeviceAction, ended
from sim_pybullet.head_axis import HeadAxis
from sim_pybullet.joints import within

STALLED_S = 3.0  # an axis that has stood still under power for so long is given up
SWAYS_HZ = (2.37, 3.71)  # of the mast, about pan and tilt; no multiples of a tick or of a frame
SWAY_PHASES_RAD = (0.6, 1.9)


class SimHead:
    """The port, and the true angles for the cameras. `sway_rad` is how far the mast trembles to each side."""

    def __init__(self, calibration: HeadCalibration, clock: Clock, rng: np.random.Generator) -> None:
        self._calibration, self._clock, self._rng = calibration, clock, rng
        pan_error, tilt_error = self._draw_error()
        self.pan = HeadAxis(calibration.speed_rad_s, pan_error)
        self.tilt = HeadAxis(calibration.speed_rad_s, tilt_error)
        self.sway_rad = 0.0
        self._action: DeviceAction[HeadReading] | None = None
        self._stalled_s = 0.0

    def _draw_error(self) -> tuple[float, float]:
        unit = self._rng.uniform(-1.0, 1.0, 2)
        return (
            float(unit[0]) * self._calibration.pan_accuracy_rad,
            float(unit[1]) * self._calibration.tilt_accuracy_rad,
        )

    @property
    def moving(self) -> bool:
        """Whether a move is under way."""
        return self._action is not None

    @property
    def true_rad(self) -> tuple[float, float]:
        """Pan and tilt as they really are."""
        if self.sway_rad == 0.0:
            return self.pan.true_rad, self.tilt.true_rad
        sway_pan, sway_tilt = (
            self.sway_rad * math.sin(2 * math.pi * hertz * self._clock.now_s + phase)
            for hertz, phase in zip(SWAYS_HZ, SWAY_PHASES_RAD, strict=True)
        )
        return self.pan.true_rad + sway_pan, self.tilt.true_rad + sway_tilt

    def point(self, pan_rad: float, tilt_rad: float) -> Action[HeadReading]:
        """Turn to these angles; a move under way ends CANCELLED."""
        limit = self._calibration.pan_limit_rad
        if not (within(pan_rad, (-limit, limit)) and within(tilt_rad, self._calibration.tilt_limits_rad)):
            detail = f"pan {math.degrees(pan_rad):.1f} deg, tilt {math.degrees(tilt_rad):.1f} deg"
            return ended(Outcome(Reason.OUT_OF_REACH, detail))
        self.stop()
        self.pan.target_rad, self.tilt.target_rad = pan_rad, tilt_rad
        if self.pan.arrived and self.tilt.arrived:  # no move, no new error
            return ended(Outcome(Reason.DONE, value=self.read()))
        self.pan.error_rad, self.tilt.error_rad = self._draw_error()
        self._action, self._stalled_s = DeviceAction(self.stop), 0.0
        return self._action

    def stop(self) -> None:
        """Stay where the head is."""
        self.pan.stop()
        self.tilt.stop()
        if self._action is not None:
            self._action.end(Outcome(Reason.CANCELLED))
            self._action = None

    def advance(self, tick_s: float) -> None:
        """Turn for one tick. Call before the clock counts it, `read` after."""
        if self._action is None:
            return
        before = self.pan.angle_rad, self.tilt.angle_rad
        self.pan.advance(tick_s)
        self.tilt.advance(tick_s)
        still = before == (self.pan.angle_rad, self.tilt.angle_rad)
        self._stalled_s = self._stalled_s + tick_s if still else 0.0

    def settle(self) -> None:
        """End the move if both axes have arrived or stand still; the clock counts the tick already."""
        if self.pan.arrived and self.tilt.arrived:
            self._end(Reason.DONE)
        elif self._stalled_s >= STALLED_S:
            stuck = "tilt" if self.pan.arrived else "pan"
            self._end(Reason.DEVICE, f"{stuck} stands still under power")

    def _end(self, reason: Reason, detail: str = "") -> None:
        action, self._action = self._action, None
        self.pan.stop()
        self.tilt.stop()
        if action is not None:
            action.end(Outcome(reason, detail, self.read()))

    def read(self) -> HeadReading:
        """What the encoders say."""
        return HeadReading(self._clock.now_s, self.pan.angle_rad, self.tilt.angle_rad, self.moving)
