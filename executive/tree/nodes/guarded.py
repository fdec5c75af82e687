"""A node under its guards: skip_if, success_if, failure_if, while."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.types import Reason
from executive.tree.expressions.guards import Guard, UndecidedError
from executive.tree.expressions.typed import Read
from executive.tree.nodes.ending import EndingDecorator
from executive.tree.trace import Trace


class Guarded(EndingDecorator):
    """Its child under skip_if, success_if, failure_if (looked at on entry) and while (at every tick).

    `skipped` is what a skipped node counts as: SUCCESS in a sequence or parallel, FAILURE in a selector.
    A guard that cannot be decided fails closed: the node does not go on under a `while` or `failure_if` that
    nobody can answer, and it is neither skipped nor taken for done by a `skip_if` or `success_if`.
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
        if decided is None:
            decided = self.failing("while", False)
        if decided is not None:
            self.end(decided)
            yield self
            return
        yield from super().tick()

    def on_entry(self) -> Status | None:
        """How the node ends without having begun; None where it may begin."""
        failed = self.failing("failure_if", True)
        if failed is not None:
            return failed
        for word, status in (("success_if", Status.SUCCESS), ("skip_if", self.skipped)):
            if word in self.guards and self.guards[word].holds(self.read):
                self.feedback_message = f"{word} {self.guards[word].text}"
                return status
        return None

    def failing(self, word: str, when: bool) -> Status | None:
        """The node's failure where this guard says so, or cannot say; None where it may go on."""
        if word not in self.guards:
            return None
        guard = self.guards[word]
        try:
            fails, why = guard.decide(self.read) is when, ""
        except UndecidedError as undecided:
            fails, why = True, f" cannot be decided: {undecided}"
        return self.fail(Reason.GUARD, f"{word} {guard.text}{why}") if fails else None

    def update(self) -> Status:
        status: Status = self.decorated.status
        return status
