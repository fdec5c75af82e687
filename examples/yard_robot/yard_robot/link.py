"""The radio in the yard: somebody is within call, and asks the robot to hold."""

from __future__ import annotations

from executive.core.clock import Clock
from executive.core.types import Call
from longarm import Action, Outcome, Reason

from yard_robot.actions import DeviceAction

ANSWER_S = 60.0


class YardLink:
    """The port."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._waiting: list[tuple[float, Call, DeviceAction[str]]] = []

    def call(self, call: Call) -> Action[str]:
        """Send; ends DONE with the answer."""
        action: DeviceAction[str] = DeviceAction()
        self._waiting.append((self._clock.now_s + ANSWER_S, call, action))
        return action

    def settle(self) -> None:
        """Deliver what is due; called once after each tick."""
        now_s = self._clock.now_s
        for due_s, call, action in self._waiting:
            if due_s <= now_s:
                action.end(Outcome(Reason.DONE, "answer", f"received: {call.reason.value}; hold"))
        self._waiting = [waiting for waiting in self._waiting if waiting[0] > now_s]
