"""What the tests of port faults share: a robot, a switch for the fault, cameras that return images."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from executive.config.backends import BackendRequest
from executive.core.devices import CAMERAS, HEAD
from executive.core.rig import RigCalibration
from executive.core.types import (
    Centres,
    HeadReading,
    Images,
    Outcome,
    Point,
    Reason,
    Segment,
    Shot,
    Window,
)
from executive.run.fault import Cue, Fault
from executive.testing.fake import FakeBackend, FakeWorld

ROUTE = (Segment(Point(3.0, 0.0), Point(4.0, 0.0), 0.03, 0.25, 0.03),)
SHOT = Shot((0, 1, 2, 4, 8))
WINDOWS = (Window(100, 200, 40, 30), Window(300, 210, 36, 28))


@dataclass
class Level:
    """How strong the fault is; a test sets it."""

    now: float = 1.0

    def __call__(self) -> float:
        return self.now


@dataclass
class Ready:
    """An action that is over."""

    outcome: Outcome[Any]

    def poll(self) -> Outcome[Any]:
        return self.outcome

    def cancel(self) -> None: ...


class Bench:
    """A fake robot, and a fault around its devices."""

    def __init__(self) -> None:
        request = BackendRequest(FakeWorld(), ROUTE, 1, "geometric", RigCalibration(), None, 1.0)
        self.robot = FakeBackend(request)
        self.level = Level()
        self.cue = Cue(self.level, self.robot.clock, np.random.default_rng(1))

    def around(self, fault: Fault) -> Any:
        """The devices behind the fault."""
        return fault.wrap(self.robot.devices, self.cue)

    def finish(self, action: Any, patience: int = 10_000) -> Outcome[Any]:
        """Let time pass until the action has ended."""
        for _ in range(patience):
            if (outcome := action.poll()) is not None:
                return outcome
            self.robot.advance()
        raise AssertionError("the action did not end")

    def centres(self, fault: Fault, shot: Shot = SHOT) -> tuple[Centres, Centres]:
        """What a camera fault makes of an answer of the geometric tier: before and after."""
        before = self.finish(self.robot.devices[CAMERAS].take(shot)).value
        after = self.finish(self.answering(fault, before).take(shot)).value
        return before, after

    def images(self, fault: Fault) -> tuple[Images, Images]:
        """The same for images, a gradient with a bright pixel that goes on and off."""
        before = images(self.robot.devices[HEAD].read())
        return before, self.finish(self.answering(fault, before).take(before.shot)).value

    def answering(self, fault: Fault, answer: Images | Centres) -> Any:
        """Cameras that always return this answer, behind the fault."""

        class Cameras:
            def take(self, shot: Shot) -> Ready:
                windows = {"windows": shot.windows} if isinstance(answer, Images) else {}
                return Ready(Outcome(Reason.DONE, value=replace(answer, shot=shot, **windows)))

        return fault.wrap(self.robot.devices.replace(CAMERAS, Cameras()), self.cue)[CAMERAS]


def images(head: HeadReading) -> Images:
    """Two windows of different size, dark at the left and bright at the right, the markers lit in turn."""
    shot = replace(SHOT, windows=WINDOWS)
    left, right = (_stack(window) for window in WINDOWS)
    return Images(0.0, shot, WINDOWS, (left, right), head)


def _stack(window: Window) -> Any:
    ramp = np.linspace(100.0, 400.0, window.width)
    stack = np.broadcast_to(ramp, (len(SHOT.leds), window.height, window.width)).astype(np.uint16)
    stack[1:, 15, 18] += 200
    return stack
