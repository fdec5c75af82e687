"""The base of decorators that may end on their own account."""

from __future__ import annotations

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.decorators import Decorator

from executive.core.types import Outcome, Reason
from executive.tree.trace import Trace


class EndingDecorator(Decorator):
    """A decorator that may end on its own account, and then says why."""

    def __init__(self, child: Behaviour, name: str, path: str, trace: Trace) -> None:
        super().__init__(child=child, name=name)
        self.path, self.trace = path, trace

    def fail(self, reason: Reason, detail: str) -> Status:
        """Note the failure; a child still running is halted by `Decorator.stop`."""
        outcome: Outcome[object] = Outcome(reason, detail)
        self.feedback_message = detail
        self.trace.fail(self.path, outcome)
        return Status.FAILURE

    def end(self, status: Status) -> None:
        """End without having ticked the child this time."""
        self.stop(status)
