"""The camera's port: a picture of a window of its sensor, some seconds after it was asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from executive.core.clock import Clock
from executive.core.types import Window
from longarm import Action, Outcome, Reason

from yard_robot.actions import DeviceAction
from yard_robot.pole_camera import Image


@dataclass(frozen=True, eq=False)
class Picture:
    """Counts (height, width) of a window of the sensor, exposed at `time_s`."""

    time_s: float
    window: Window
    counts: Image


class Eye(Protocol):
    """A fixed camera."""

    def expose(self, window: Window) -> Action[Picture]:
        """Take a picture of this part of the sensor."""
        ...


class SimEye:
    """The port in the simulation; `draw` makes the picture at the moment of exposure."""

    def __init__(self, clock: Clock, exposure_s: float, draw: Callable[[Window], Image]) -> None:
        self._clock, self._exposure_s, self._draw = clock, exposure_s, draw
        self._waiting: list[tuple[int, Window, DeviceAction[Picture]]] = []
        self.taken = 0

    def expose(self, window: Window) -> Action[Picture]:
        """Take a picture of this part of the sensor."""
        action: DeviceAction[Picture] = DeviceAction()
        due = self._clock.ticks + max(1, self._clock.ticks_for(self._exposure_s))
        self._waiting.append((due, window, action))
        return action

    def settle(self) -> None:
        """Take the pictures that are due; called once after each tick."""
        now = self._clock.ticks
        due = [waiting for waiting in self._waiting if waiting[0] <= now]
        self._waiting = [waiting for waiting in self._waiting if waiting[0] > now]
        for _, window, action in due:
            if action.poll() is None:
                self.taken += 1
                picture = Picture(self._clock.now_s, window, self._draw(window))
                action.end(Outcome(Reason.DONE, value=picture))
