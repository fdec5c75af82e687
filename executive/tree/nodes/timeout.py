"""A limit on mission time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.clock import Clock
from executive.core.types import Reason
from executive.core.values import DURATION
from executive.tree.abilities import FAILS, RUNS, Abilities, any_of, where
from executive.tree.groot import Attribute, Groot
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.nodes.ending import EndingDecorator
from executive.tree.order import Child, Ends, Known, in_turn
from executive.tree.ports import In


def milliseconds(duration_s: object) -> str | None:
    """A duration [s] as BehaviorTree.CPP has it."""
    return str(round(duration_s * 1000)) if isinstance(duration_s, float) else None


def seconds(msec: str, children: int = 0) -> object:
    """Milliseconds as a duration; anything else stays as it is, for the check to complain of."""
    return f"{int(msec) / 1000:g} s" if msec.isdecimal() else msec


class Timeout(ControlNode):
    """Fail when the child has not ended after this mission time."""

    symbol = "◷"
    children = Children.ONE
    groot = Groot("Timeout", {"after": Attribute("msec", milliseconds, seconds)})

    after = In[float](DURATION, "mission time the child may take")

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        return _Timeout(child, context, lambda: self.after)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        return able | where(RUNS in able, FAILS)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        ends = in_turn(before, children, until=False)
        return Ends(ends.succeeded, before)

    def interrupts(self, index: int, count: int) -> bool:
        return True


class _Timeout(EndingDecorator):
    """Fails its child when it has not ended after `after_s` of mission time, read on entry."""

    def __init__(self, child: Behaviour, context: NodeContext, after_s: Callable[[], float]) -> None:
        super().__init__(child, context.name, context.path, context.trace)
        self.clock: Clock = context.services.clock
        self.after_s = after_s
        self.until_ticks = 0

    def initialise(self) -> None:
        self.until_ticks = self.clock.ticks + self.clock.ticks_for(self.after_s())

    def update(self) -> Status:
        status: Status = self.decorated.status
        if status is Status.RUNNING and self.clock.ticks >= self.until_ticks:
            return self.fail(Reason.TIMEOUT, f"not ended after {self.after_s():g} s")
        return status
