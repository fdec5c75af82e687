"""The track motors and their encoders: what is commanded, what turned, what it cost in current."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from executive.clock import Clock
from executive.ports import Action
from executive.rig import RoverCalibration
from executive.types import Outcome, Reason, TrackReading
from sim_pybullet.actions import DeviceAction, PerTick, ended

ENCODER_STEP_M = 0.0001
IDLE_CURRENT_A = 0.045
CURRENT_PER_N = 0.030
CURRENT_SIGMA_A = 0.002
# The motors are geared for the weight they carry. A slope of 30 degrees takes 0.25 of it per track; against a
# rock a track slides on its soil only at 0.3 to 0.4. One motor alone may draw more than both together.
LIMIT_PER_WEIGHT_BOTH = 0.265
LIMIT_PER_WEIGHT_ONE = 0.34
LIMIT_LASTS_S = 8.0  # a step or a stone is overcome sooner
GAIN_SIGMA = 0.004  # belts differ in length and tension: the systematic error called track synchronism


@dataclass
class _Drive:
    left_m: float
    right_m: float
    left_m_s: float
    right_m_s: float
    action: DeviceAction[TrackReading]


class SimTracks:
    """The port, and what the world asks each tick. Encoders count motors; belts run `gains` times that."""

    def __init__(
        self, rover: RoverCalibration, weight_n: float, clock: Clock, rng: np.random.Generator
    ) -> None:
        self._rover, self._clock, self._rng = rover, clock, rng
        self._weight_n = weight_n
        self.gains = (1.0 + GAIN_SIGMA * rng.standard_normal(), 1.0 + GAIN_SIGMA * rng.standard_normal())
        self.speed_factors = [1.0, 1.0]  # a weak motor turns less than commanded; its encoder sees that
        self._turned_m = [0.0, 0.0]
        self._forces_n = (0.0, 0.0)
        self._effort_n = 0.0
        self._over_s = 0.0
        self._drive: _Drive | None = None
        self._reading = PerTick(self._now, lambda: clock.ticks)

    @property
    def moving(self) -> bool:
        """Whether a drive is under way."""
        return self._drive is not None

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        """Move the belts by these travels (executive.ports.Tracks), at most as fast as the motors can."""
        if not all(map(math.isfinite, (left_m, right_m, speed_m_s))) or speed_m_s <= 0:
            detail = f"got travels {left_m}, {right_m} m at {speed_m_s} m/s, expected finite, speed above 0"
            return ended(Outcome(Reason.OUT_OF_REACH, detail))
        self.stop()
        longest_m = max(abs(left_m), abs(right_m))
        if longest_m == 0.0:
            return ended(Outcome(Reason.DONE, value=self.read()))
        lasts_s = longest_m / min(speed_m_s, self._rover.speed_m_s)
        action: DeviceAction[TrackReading] = DeviceAction(self.stop)
        self._drive = _Drive(left_m, right_m, left_m / lasts_s, right_m / lasts_s, action)
        self._over_s = 0.0
        return action

    def stop(self) -> None:
        """Stop both belts at once."""
        if self._drive is not None:
            drive, self._drive = self._drive, None
            drive.action.end(Outcome(Reason.CANCELLED))
            self._forces_n = (0.0, 0.0)

    def read(self) -> TrackReading:
        """Travels and currents, with quantisation and noise."""
        return self._reading.read()

    def turn(self, tick_s: float) -> tuple[float, float]:
        """Let the motors turn for one tick; the true travel of both belts in it [m]."""
        if self._drive is None:
            return 0.0, 0.0
        d = self._drive
        left_m = _toward(d.left_m, d.left_m_s * tick_s * self.speed_factors[0])
        right_m = _toward(d.right_m, d.right_m_s * tick_s * self.speed_factors[1])
        d.left_m, d.right_m = d.left_m - left_m, d.right_m - right_m
        self._turned_m[0] += left_m
        self._turned_m[1] += right_m
        return left_m * self.gains[0], right_m * self.gains[1]

    def feel(self, forces_n: tuple[float, float], tick_s: float) -> None:
        """Take in the belt forces of the tick; end the drive if it is done or blocked for too long."""
        if self._drive is None:
            return
        self._forces_n = (abs(forces_n[0]), abs(forces_n[1]))
        left_n = math.copysign(forces_n[0], forces_n[0] * self._drive.left_m_s)
        right_n = math.copysign(forces_n[1], forces_n[1] * self._drive.right_m_s)
        self._effort_n = abs(left_n + right_n) / 2
        self._over_s = self._over_s + tick_s if self._overcurrent else max(0.0, self._over_s - tick_s)
        if self._over_s >= LIMIT_LASTS_S:
            self._finish(Reason.BLOCKED, "motor current over its limit")
        elif abs(self._drive.left_m) < 1e-9 and abs(self._drive.right_m) < 1e-9:
            self._finish(Reason.DONE)

    @property
    def _overcurrent(self) -> bool:
        """One motor over its limit, or both together; belts that pull against each other do not add up."""
        return (
            max(self._forces_n) > LIMIT_PER_WEIGHT_ONE * self._weight_n
            or self._effort_n > LIMIT_PER_WEIGHT_BOTH * self._weight_n
        )

    def _finish(self, reason: Reason, detail: str = "") -> None:
        drive, self._drive = self._drive, None
        if drive is not None:
            last = replace(self._measure(IDLE_CURRENT_A), moving=False)
            drive.action.end(Outcome(reason, detail, last))
            self._forces_n = (0.0, 0.0)

    def _now(self) -> TrackReading:
        return self._measure(IDLE_CURRENT_A if self.moving else 0.0)

    def _measure(self, idle: float) -> TrackReading:
        noise = self._rng.standard_normal(2) * CURRENT_SIGMA_A
        left_m, right_m = (round(m / ENCODER_STEP_M) * ENCODER_STEP_M for m in self._turned_m)
        return TrackReading(
            self._clock.now_s,
            left_m,
            right_m,
            max(0.0, idle + CURRENT_PER_N * self._forces_n[0] + float(noise[0])),
            max(0.0, idle + CURRENT_PER_N * self._forces_n[1] + float(noise[1])),
            self.moving,
        )


def _toward(remaining_m: float, step_m: float) -> float:
    return remaining_m if abs(step_m) >= abs(remaining_m) - 1e-12 else step_m
