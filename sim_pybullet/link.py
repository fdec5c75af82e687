"""The link to ground: a call takes 20 minutes, the answer another 20."""

from __future__ import annotations

from executive.core.clock import Clock
from executive.core.ports import Action
from executive.core.types import Call, Outcome, Reason
from sim_pybullet.actions import DeviceAction

ONE_WAY_S = 20 * 60.0


class SimLink:
    """The port. Ground has no operator here: it confirms the call and asks to hold."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._waiting: list[tuple[float, Call, DeviceAction[str]]] = []

    def call(self, call: Call) -> Action[str]:
        """Send; ends DONE with the answer after the light has gone both ways."""
        action: DeviceAction[str] = DeviceAction()
        self._waiting.append((self._clock.now_s + 2 * ONE_WAY_S, call, action))
        return action

    def settle(self) -> None:
        """Deliver what is due."""
        now_s = self._clock.now_s
        for _, call, action in (w for w in self._waiting if w[0] <= now_s):
            action.end(Outcome(Reason.DONE, "answer from ground", f"received: {call.reason.value}; hold"))
        self._waiting = [w for w in self._waiting if w[0] > now_s]
