"""The one adapter between leaves and devices: start an action, watch it, cancel it when interrupted."""

from __future__ import annotations

from typing import Any, ClassVar

from executive.core.ports import Action
from executive.core.types import Outcome, Reason
from executive.core.values import DURATION
from executive.tree.nodes.leaf import Leaf
from executive.tree.ports import In

PATIENCE_S = 600.0
"""Longer than any joint needs from stop to stop, or the cameras for a sequence."""


class ActionLeaf(Leaf):
    """A leaf that runs one `Action`. Subclasses write `request`; if needed, `due_s`, `watch` and `finish`.

    It waits for its action no longer than it is due and `patience` beyond: then the action is cancelled, and
    the leaf finishes as if it had ended with `late`. No device that falls silent can hold a mission for ever.
    """

    patience = In[float](DURATION, "how late what is waited for may be", default=PATIENCE_S)

    late: ClassVar[Reason] = Reason.DEVICE

    _action: Action[Any] | None = None
    _settled: Outcome[Any] | None = None

    def request(self) -> Action[Any] | Outcome[Any]:
        """Start the action; or an outcome, where there is nothing to start."""
        raise TypeError(f"{type(self).__name__} has no request")

    def due_s(self) -> float:
        """How long the action, once started, may take by what was asked of it [s]."""
        return 0.0

    def watch(self) -> Outcome[Any] | None:
        """Look on, once a tick while under way; an outcome ends the leaf and cancels the action."""
        return None

    def finish(self, outcome: Outcome[Any]) -> Outcome[Any]:
        """Make of the action's outcome the leaf's own."""
        return outcome

    def begin(self) -> None:
        self._action, self._settled = None, None
        self.start()

    def start(self) -> None:
        """Start the action, and its time."""
        patience_s, started = self.patience, self.request()
        if isinstance(started, Outcome):
            self._settled = started
        else:
            self._action = started
            self._wait_s = self.due_s() + patience_s
            clock = self.services.clock
            self._until_ticks = clock.ticks + clock.ticks_for(self._wait_s)

    def step(self) -> Outcome[object] | None:
        if self._action is None:
            return self._settled
        outcome = self._action.poll()
        if outcome is not None:
            self._action = None
            return self.finish(outcome)
        return self.watch() or self._given_up()

    def _given_up(self) -> Outcome[object] | None:
        """What comes of an action that is too late; None for one that is not."""
        if self._action is None or self.services.clock.ticks < self._until_ticks:
            return None
        self._action.cancel()
        self._action = None
        return self.finish(Outcome(self.late, f"no answer after {self._wait_s:.0f} s"))

    def halt(self) -> None:
        if self._action is not None:
            self._action.cancel()
            self._action = None
