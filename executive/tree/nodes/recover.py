"""The pool composite: when its child fails, the pool chooses a strategy, which runs; then the child again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Composite

from executive.core.types import Outcome, Reason
from executive.core.values import INTEGER, SEGMENT
from executive.tree.abilities import FAILS, RUNS, Abilities, any_of, where
from executive.tree.nodes import situation
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.nodes.leaf import ErrorsOf
from executive.tree.ports import In
from executive.tree.trace import Trace

Choose = Callable[[Outcome[object], frozenset[str]], str | None]
"""Asks the pool: the failure and the strategies at hand here; the one to try, or None to call home."""

Conclude = Callable[[bool, bool], None]
"""Tells the pool whether the strategy chosen last helped, and whether that was verified by the child."""


class Recover(ControlNode):
    """Run the child; when it fails, let the pool choose a strategy, then run it again."""

    symbol = "✚"
    needs = ("drive",)
    children = Children.ONE
    recovers = True

    attempts = In[int](INTEGER, "the most strategies to try", fixed=True, least=1)

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        services, segment = context.services, context.value("segment", SEGMENT)

        def choose(failure: Outcome[object], at_hand: frozenset[str]) -> str | None:
            return situation.choose(services, segment.read(), failure, at_hand)

        def conclude(helped: bool, verified: bool) -> None:
            situation.conclude(services, segment.read() if verified else None, helped)

        made = context.strategies()
        return _Recover(
            context.name, context.path, context.trace, choose, conclude, self.attempts, child, made
        )

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        return able | where(FAILS in able, RUNS)


class _Recover(Composite):
    """Runs `child`; at most `attempts` times it lets the pool answer a failure by one of `strategies`.

    A strategy helped when its own tree succeeded and the child, run again, did not fail for the same
    reason. Which child runs is decided at run time; a drawing shows them all.
    """

    def __init__(
        self,
        name: str,
        path: str,
        trace: Trace,
        choose: Choose,
        conclude: Conclude,
        attempts: int,
        child: Behaviour,
        strategies: Mapping[str, Behaviour],
    ) -> None:
        super().__init__(name, [child, *strategies.values()])
        self.path, self.trace, self.attempts = path, trace, attempts
        self.choose, self.conclude = choose, conclude
        self.child, self.strategies = child, strategies
        self.under_way: Behaviour = child
        self.begin()

    def begin(self) -> None:
        self.tried = 0
        self.failure: Outcome[object] | None = None
        self.strategy: str | None = None
        self.unverified: str | None = None

    def tick(self) -> Iterator[Behaviour]:
        if self.status is not Status.RUNNING:
            self.begin()
            self.turn_to(self.child)
            self.trace.last_failure = None
        running = self.under_way
        yield from running.tick()
        status = self.after_child() if running is self.child else self.after_strategy()
        if status is Status.RUNNING:
            self.status = status
        else:
            self.stop(status)
        yield self

    def turn_to(self, child: Behaviour) -> None:
        self.under_way = self.current_child = child

    def after_child(self) -> Status:
        """The child has had its tick: done, under way, or failed, which is for the pool to answer."""
        if self.child.status is Status.RUNNING:
            return Status.RUNNING
        failure = self.failure_of_child() if self.child.status is Status.FAILURE else None
        self.verify(failure)
        if failure is None:
            return Status.SUCCESS
        return self.answer(failure)

    def failure_of_child(self) -> Outcome[object]:
        noted = self.trace.last_failure
        return noted[1] if noted else Outcome(Reason.UNEXPECTED, f"{self.child.name} failed without a reason")

    def verify(self, failure: Outcome[object] | None) -> None:
        """Tell the pool what came of the strategy that ran before the child."""
        if self.unverified is not None:
            same = failure is not None and self.failure is not None and failure.reason is self.failure.reason
            self.conclude(not same, True)
            self.unverified = None

    def answer(self, failure: Outcome[object]) -> Status:
        """Start the strategy that the pool chooses, or fail."""
        self.failure = failure
        if self.tried >= self.attempts:
            return self.give_up(f"{self.attempts} attempts used up")
        with ErrorsOf(self.path):
            name = self.choose(failure, frozenset(self.strategies))
        if name is None:
            return self.give_up("no strategy fits")
        if name not in self.strategies:
            known = ", ".join(self.strategies) or "none"
            raise LookupError(
                f"{self.path}: the pool chose {name!r}, which is not one of its strategies: {known}"
            )
        self.tried += 1
        self.strategy = name
        self.feedback_message = f"trying {name} ({self.tried} of {self.attempts})"
        self.turn_to(self.strategies[name])
        return Status.RUNNING

    def give_up(self, why: str) -> Status:
        """Fail, keeping the physical reason in the detail."""
        failure = self.failure
        detail = f"{why}; {failure.reason}: {failure.detail}" if failure else why
        outcome: Outcome[object] = Outcome(Reason.NO_STRATEGY, detail)
        self.feedback_message = detail
        self.trace.fail(self.path, outcome)
        return Status.FAILURE

    def after_strategy(self) -> Status:
        """The strategy has had its tick: under way, done (to be verified by the child), or failed."""
        if self.strategy is None or self.failure is None:
            raise RuntimeError(f"{self.path}: a strategy ran that was not chosen")
        status = self.strategies[self.strategy].status
        if status is Status.RUNNING:
            return Status.RUNNING
        if status is Status.FAILURE:
            self.conclude(False, False)
            return self.answer(self.failure)
        self.unverified = self.strategy
        self.trace.last_failure = None
        self.turn_to(self.child)
        return Status.RUNNING

    def stop(self, new_status: Status = Status.INVALID) -> None:
        """Halt whatever is under way."""
        for child in self.children:
            if child.status is Status.RUNNING:
                child.stop(Status.INVALID)
        super().stop(new_status)
