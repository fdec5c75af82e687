"""The husky's wheels behind the port of a drive: travel as the encoders count it, currents of the motors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from executive.core.clock import Clock
from executive.core.types import TrackReading
from longarm import Action, Outcome, Reason

from yard_robot.actions import DeviceAction, PerTick

Pair = tuple[float, float]

IDLE_A, ROLLING_A, SCRUBBING_A = 0.2, 2.0, 0.5
"""Currents of one side: at rest, more when it rolls, and more when it skids sideways in a turn."""
_NOISE_A = 0.05
_BLOCKED_M = 0.25  # a wheel that has fallen so far behind its command is held by something
_CATCH_UP = 1.5  # of its own speed: how fast a wheel may go to make up for what it lost


class Wheels:
    """A drive by travel. The world asks it for speeds step by step and tells it what the encoders counted."""

    def __init__(self, clock: Clock, rng: np.random.Generator, travels: Callable[[], Pair]) -> None:
        self._clock, self._travels = clock, travels
        self._action: DeviceAction[TrackReading] | None = None
        self._from_m, self._way_m = (0.0, 0.0), (0.0, 0.0)
        self._lasts_s, self._elapsed_s = 0.0, 0.0
        self.load_a: Pair = (IDLE_A, IDLE_A)
        self._currents = PerTick(lambda: self._drawn(rng), lambda: clock.ticks)

    @property
    def turning(self) -> bool:
        """Whether a drive is under way."""
        return self._action is not None

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        """Turn the treads by these travels, both ending together; the faster side at `speed_m_s`."""
        self.stop()
        self._from_m, self._way_m = self._travels(), (left_m, right_m)
        self._lasts_s, self._elapsed_s = max(abs(left_m), abs(right_m)) / speed_m_s, 0.0
        self._action = DeviceAction(self.stop)
        return self._action

    def stop(self) -> None:
        """Stop all wheels at once."""
        if self._action is not None:
            action, self._action = self._action, None
            action.end(Outcome(Reason.CANCELLED))

    def fail(self, why: str) -> None:
        """Stop all wheels because the device cannot go on."""
        if self._action is not None:
            action, self._action = self._action, None
            action.end(Outcome(Reason.DEVICE, why, self.read()))

    def speeds(self, step_s: float) -> Pair:
        """The treads' speeds for the next step, so that they are where they should be after it."""
        if self._action is None:
            return 0.0, 0.0
        self._elapsed_s += step_s
        share = min(self._elapsed_s / self._lasts_s, 1.0) if self._lasts_s else 1.0
        limit = _CATCH_UP * max(map(abs, self._way_m)) / self._lasts_s if self._lasts_s else 0.0
        counted = self._travels()
        left, right = (
            min(max((self._from_m[side] + share * self._way_m[side] - counted[side]) / step_s, -limit), limit)
            for side in (0, 1)
        )
        return left, right

    def settle(self) -> None:
        """End the drive when it is done, or when a wheel is held; called once after each tick."""
        if self._action is None:
            return
        share = min(self._elapsed_s / self._lasts_s, 1.0) if self._lasts_s else 1.0
        counted = self._travels()
        behind_m = max(abs(self._from_m[side] + share * self._way_m[side] - counted[side]) for side in (0, 1))
        if share < 1.0 and behind_m <= _BLOCKED_M:
            return
        action, self._action = self._action, None
        if behind_m > _BLOCKED_M:
            action.end(Outcome(Reason.BLOCKED, f"a wheel is {behind_m * 1e3:.0f} mm behind", self.read()))
        else:
            action.end(Outcome(Reason.DONE, value=self.read()))

    def read(self) -> TrackReading:
        """Encoders and currents."""
        left_m, right_m = self._travels()
        left_a, right_a = self._currents.read()
        return TrackReading(self._clock.now_s, left_m, right_m, left_a, right_a, self.turning)

    def _drawn(self, rng: np.random.Generator) -> Pair:
        left, right = (np.array(self.load_a) + rng.normal(0.0, _NOISE_A, 2)).tolist()
        return max(left, 0.0), max(right, 0.0)
