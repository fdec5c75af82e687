"""The track motors and their encoders: what is commanded, what turned, what it cost in current."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from executive.core.clock import Clock
from executive.core.ports import Action
from executive.core.rig import RoverCalibration
from executive.core.types import Outcome, Reason, TrackReading
from sim_pybullet.actions import DeviceAction, PerTick, ended
from sim_pybullet.motor import Motor

ENCODER_STEP_M = 0.0001
IDLE_CURRENT_A = 0.045
CURRENT_PER_N = 0.030
CURRENT_SIGMA_A = 0.002
# The motors are geared for the weight they carry. A slope of 30 degrees takes 0.25 of it per track; against a
# rock a track slides on its soil only at 0.3 to 0.4. One motor alone may draw more than both together.
LIMIT_PER_WEIGHT_BOTH = 0.265
LIMIT_PER_WEIGHT_ONE = 0.34
STALL_PER_WEIGHT = 0.40  # what a jammed motor pushes with
LIMIT_LASTS_S = 8.0  # a step or a stone is overcome sooner
GAIN_SIGMA = 0.004  # belts differ in length and tension: the systematic error called track synchronism


@dataclass
class _Drive:
    remaining_m: list[float]
    speeds_m_s: tuple[float, float]
    action: DeviceAction[TrackReading]


class SimTracks:
    """The port, and what the world asks each tick. Encoders count motors; belts run `gains` times that."""

    def __init__(
        self, rover: RoverCalibration, weight_n: float, clock: Clock, rng: np.random.Generator
    ) -> None:
        self._rover, self._clock, self._rng = rover, clock, rng
        self._weight_n = weight_n
        self.gains = (1.0 + GAIN_SIGMA * rng.standard_normal(), 1.0 + GAIN_SIGMA * rng.standard_normal())
        self.motors = (Motor(), Motor())
        self.driven_m = 0.0  # true travel of both belts so far, whichever way
        self._turned_m = [0.0, 0.0]
        self._forces_n = (0.0, 0.0)
        self._effort_n = 0.0
        self._over_s = 0.0
        self._drive: _Drive | None = None
        self._run_on: list[tuple[float, float]] = [(0.0, 0.0)] * 2  # speed [m/s], time left [s]
        self._reading = PerTick(self._now, lambda: clock.ticks)

    @property
    def moving(self) -> bool:
        """Whether a drive is under way."""
        return self._drive is not None

    @property
    def turning(self) -> bool:
        """Whether a belt may turn: in a drive, or because its motor does not stop."""
        return self.moving or any(left_s > 0.0 for _, left_s in self._run_on)

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        """Move the belts by these travels (core.ports.Tracks), at most as fast as the motors can."""
        if not all(map(math.isfinite, (left_m, right_m, speed_m_s))) or speed_m_s <= 0:
            detail = f"got travels {left_m}, {right_m} m at {speed_m_s} m/s, expected finite, speed above 0"
            return ended(Outcome(Reason.OUT_OF_REACH, detail))
        self.stop()
        longest_m = max(abs(left_m), abs(right_m))
        if longest_m == 0.0:
            return ended(Outcome(Reason.DONE, value=self.read()))
        lasts_s = longest_m / min(speed_m_s, self._rover.speed_m_s)
        action: DeviceAction[TrackReading] = DeviceAction(self.stop)
        self._drive = _Drive([left_m, right_m], (left_m / lasts_s, right_m / lasts_s), action)
        self._over_s, self._run_on = 0.0, [(0.0, 0.0)] * 2
        return action

    def stop(self) -> None:
        """Stop both belts at once, as far as their motors do."""
        if self._drive is not None:
            self._end(self._drive).end(Outcome(Reason.CANCELLED))

    def _end(self, drive: _Drive) -> DeviceAction[TrackReading]:
        """Take the power off; what is left to do is to end the action."""
        self._drive = None
        self._forces_n = (0.0, 0.0)
        speeds = (m.speed_factor * v for m, v in zip(self.motors, drive.speeds_m_s, strict=True))
        self._run_on = [(v, m.runs_on_s) for m, v in zip(self.motors, speeds, strict=True)]
        return drive.action

    def read(self) -> TrackReading:
        """Travels and currents, with quantisation and noise."""
        return self._reading.read()

    def turn(self, tick_s: float) -> tuple[float, float]:
        """Let the motors turn for one tick; the true travel of both belts in it [m]."""
        left_m, right_m = (self._shaft(side, tick_s) for side in (0, 1))
        self._turned_m[0] += left_m
        self._turned_m[1] += right_m
        belts_m = left_m * self.gains[0], right_m * self.gains[1]
        self.driven_m += abs(belts_m[0]) + abs(belts_m[1])
        return belts_m

    def _shaft(self, side: int, tick_s: float) -> float:
        """How far a motor's shaft turns in a tick, as travel of its belt."""
        if self._drive is not None:
            d = self._drive
            turned_m = self.motors[side].turn(d.speeds_m_s[side] * tick_s, d.remaining_m[side])
            d.remaining_m[side] -= turned_m
            return turned_m
        speed_m_s, left_s = self._run_on[side]
        turned_m = speed_m_s * min(tick_s, left_s)
        self._run_on[side] = (speed_m_s, max(0.0, left_s - tick_s))
        self.motors[side].astray_m += abs(turned_m)
        return turned_m

    def feel(self, forces_n: tuple[float, float], tick_s: float) -> None:
        """Take in the belt forces of the tick; end the drive if it is done or blocked for too long."""
        drive = self._drive
        if drive is None:
            return
        left_n, right_n = (self._pushes_n(drive, side, forces_n[side]) for side in (0, 1))
        self._forces_n = (abs(left_n), abs(right_n))
        self._effort_n = abs(left_n + right_n) / 2
        self._over_s = self._over_s + tick_s if self._overcurrent else max(0.0, self._over_s - tick_s)
        if self._over_s >= LIMIT_LASTS_S:
            self._finish(drive, Reason.BLOCKED, "motor current over its limit")
        elif all(abs(m) < 1e-9 for m in drive.remaining_m):
            self._finish(drive, Reason.DONE)

    def _pushes_n(self, drive: _Drive, side: int, force_n: float) -> float:
        """What a motor pushes its belt with, positive the way it is driven."""
        if self.motors[side].jammed and drive.remaining_m[side] != 0.0:
            return STALL_PER_WEIGHT * self._weight_n
        return math.copysign(force_n, force_n * drive.speeds_m_s[side])

    @property
    def _overcurrent(self) -> bool:
        """One motor over its limit, or both together; belts that pull against each other do not add up."""
        return (
            max(self._forces_n) > LIMIT_PER_WEIGHT_ONE * self._weight_n
            or self._effort_n > LIMIT_PER_WEIGHT_BOTH * self._weight_n
        )

    def _finish(self, drive: _Drive, reason: Reason, detail: str = "") -> None:
        last = replace(self._measure(IDLE_CURRENT_A), moving=False)
        self._end(drive).end(Outcome(reason, detail, last))

    def _now(self) -> TrackReading:
        return self._measure(IDLE_CURRENT_A if self.turning else 0.0)

    def _measure(self, idle: float) -> TrackReading:
        noise = self._rng.standard_normal(2) * CURRENT_SIGMA_A
        left_m, right_m = (round(m / ENCODER_STEP_M) * ENCODER_STEP_M for m in self._turned_m)
        return TrackReading(
            self._clock.now_s,
            left_m,
            right_m,
            self._current_a(0, idle, float(noise[0])),
            self._current_a(1, idle, float(noise[1])),
            self.turning,
        )

    def _current_a(self, side: int, idle_a: float, noise_a: float) -> float:
        drawn_a = idle_a + CURRENT_PER_N * self._forces_n[side] if self.motors[side].powered else 0.0
        return max(0.0, drawn_a + noise_a)
