"""A node under its guards: skip_if, success_if, failure_if, while."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.types import Reason
from executive.tree.expressions.guards import Guard
from executive.tree.expressions.typed import Read
from executive.tree.nodes.ending import EndingDecorator
from executive.tree.trace import Trace


class Guarded(EndingDecorator):
    """Its child under skip_if, success_if, failure_if (looked at on entry) and while (at every tick).

    `skipped` is what a skipped node counts as: SUCCESS in a sequence or parallel, FAILURE in a selector.
    A guard that cannot be decided, because a value is unset, changes nothing.
    """

    def __init__(
        self,
        child: Behaviour,
        name: str,
        path: str,
        trace: Trace,
        guards: Mapping[str, Guard],
        read: Read,
        skipped: Status,
    ) -> None:
        super().__init__(child, name, path, trace)
        self.guards, self.read, self.skipped = guards, read, skipped

    def tick(self) -> Iterator[Behaviour]:
        self.feedback_message = ""
        decided = self.on_entry() if self.status is not Status.RUNNING else None
        if decided is None and self.holds("while") is False:
            decided = self.fail(Reason.GUARD, f"while {self.guards['while'].text}")
        if decided is not None:
            self.end(decided)
            yield self
            return
        yield from super().tick()

    def on_entry(self) -> Status | None:
        if self.holds("failure_if"):
            return self.fail(Reason.GUARD, f"failure_if {self.guards['failure_if'].text}")
        if self.holds("success_if"):
            self.feedback_message = f"success_if {self.guards['success_if'].text}"
            return Status.SUCCESS
        if self.holds("skip_if"):
            self.feedback_message = f"skip_if {self.guards['skip_if'].text}"
            return self.skipped
        return None

    def holds(self, word: str) -> bool | None:
        return self.guards[word].holds(self.read) if word in self.guards else None

    def update(self) -> Status:
        status: Status = self.decorated.status
        return status
