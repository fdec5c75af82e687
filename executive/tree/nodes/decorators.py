"""Decorators of our own: guards, mission-clock timeout, and an iteration that handles empty lists."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.decorators import Decorator

from executive.core.clock import Clock
from executive.core.types import Outcome, Reason
from executive.tree.expressions.guards import Guard
from executive.tree.expressions.typed import Read
from executive.tree.nodes.base import Binding, Slot, Trace


class _Ending(Decorator):
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


class Guarded(_Ending):
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


class Timeout(_Ending):
    """Fails its child when it has not ended after `after` of mission time."""

    def __init__(
        self, child: Behaviour, name: str, path: str, trace: Trace, clock: Clock, after: Binding
    ) -> None:
        super().__init__(child, name, path, trace)
        self.clock, self.after = clock, after
        self.until_ticks = 0

    def initialise(self) -> None:
        self.until_ticks = self.clock.ticks + self.clock.ticks_for(self.after.read())

    def update(self) -> Status:
        status: Status = self.decorated.status
        if status is Status.RUNNING and self.clock.ticks >= self.until_ticks:
            return self.fail(Reason.TIMEOUT, f"not ended after {self.after.read():g} s")
        return status


class ForEach(Decorator):
    """Runs its child once per item, in order; none for an empty list. Fails as soon as the child does.

    py_trees' own ticks its child once for an empty list and stops at an item None.
    """

    def __init__(self, child: Behaviour, name: str, items: Binding, item: Slot) -> None:
        super().__init__(child=child, name=name)
        self.items, self.item = items, item
        self.remaining: list[object] = []

    def initialise(self) -> None:
        given: Sequence[object] | None = self.items.read()
        self.remaining = list(given or ())
        if self.remaining:
            self.item.write(self.remaining[0])

    def tick(self) -> Iterator[Behaviour]:
        if self.status is not Status.RUNNING:
            self.initialise()
            if not self.remaining:
                self.stop(Status.SUCCESS)
                yield self
                return
            self.status = Status.RUNNING
        yield from super().tick()

    def update(self) -> Status:
        status: Status = self.decorated.status
        if status is not Status.SUCCESS:
            return status
        self.remaining.pop(0)
        if not self.remaining:
            return Status.SUCCESS
        self.item.write(self.remaining[0])
        return Status.RUNNING
