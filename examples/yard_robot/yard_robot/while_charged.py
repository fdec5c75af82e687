"""A control node of this robot: go on as long as the battery allows it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from executive.tree.nodes.ending import EndingDecorator
from longarm import (
    FAILS,
    NUMBER,
    Abilities,
    Children,
    ControlNode,
    In,
    NodeContext,
    Outcome,
    Reason,
)
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from yard_robot.devices import BATTERY


class WhileCharged(ControlNode):
    """Run the child while the battery is charged by `least` or more; halt it and fail below."""

    symbol = "▮"
    children = Children.ONE
    needs = ("battery",)

    least = In[float](NUMBER, "state of charge that the battery must have, 0 to 1", default=0.15)

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        return _WhileCharged(child, self, context)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        (able,) = inside
        return able | {FAILS}

    def interrupts(self, index: int, count: int) -> bool:
        return True


class _WhileCharged(EndingDecorator):
    """Looks at the gauge before each tick of its child. A no is evidence for the classification."""

    def __init__(self, child: Behaviour, node: WhileCharged, context: NodeContext) -> None:
        super().__init__(child, context.name, context.path, context.trace)
        self.node, self.services = node, context.services

    def tick(self) -> Iterator[Behaviour]:
        self.feedback_message = ""
        charge = self.services.devices[BATTERY].read().charge
        if charge >= self.node.least:
            yield from super().tick()
            return
        detail = f"battery at {charge:.0%}, needs {self.node.least:.0%}"
        self.services.classification.on_failure(Outcome(Reason.DEVICE, detail))
        self.end(self.fail(Reason.DEVICE, detail))
        yield self

    def update(self) -> Status:
        status: Status = self.decorated.status
        return status
