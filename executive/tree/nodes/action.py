"""The one adapter between leaves and devices: start an action, watch it, cancel it when interrupted."""

from __future__ import annotations

from typing import Any

from executive.core.ports import Action
from executive.core.types import Outcome
from executive.tree.nodes.leaf import Leaf


class ActionLeaf(Leaf):
    """A leaf that runs one `Action`. Subclasses write `request` and, if needed, `watch` and `finish`."""

    _action: Action[Any] | None = None
    _settled: Outcome[Any] | None = None

    def request(self) -> Action[Any] | Outcome[Any]:
        """Start the action; or an outcome, where there is nothing to start."""
        raise TypeError(f"{type(self).__name__} has no request")

    def watch(self) -> Outcome[Any] | None:
        """Look on, once a tick while under way; an outcome ends the leaf and cancels the action."""
        return None

    def finish(self, outcome: Outcome[Any]) -> Outcome[Any]:
        """Make of the action's outcome the leaf's own."""
        return outcome

    def begin(self) -> None:
        self._action, self._settled = None, None
        started = self.request()
        if isinstance(started, Outcome):
            self._settled = started
        else:
            self._action = started

    def step(self) -> Outcome[object] | None:
        if self._action is None:
            return self._settled
        outcome = self._action.poll()
        if outcome is not None:
            self._action = None
            return self.finish(outcome)
        return self.watch()

    def halt(self) -> None:
        if self._action is not None:
            self._action.cancel()
            self._action = None
