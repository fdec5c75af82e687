"""Once for each item of a list."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.decorators import Decorator

from executive.core.types import Segment
from executive.core.values import ROUTE
from executive.tree.abilities import RUNS, SUCCEEDS, Abilities, any_of, where
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.ports import In, Item


class ForEach(ControlNode):
    """Run the child once for each item, in order, until it fails."""

    symbol = "∀"
    children = Children.ONE

    items = In[tuple[Segment, ...]](ROUTE, "the items", name="in")
    item = Item("the name under which the child sees the item", of="in", name="as")

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        return _ForEach(child, context.name, self)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        return able | where(True, SUCCEEDS) | where(SUCCEEDS in able, RUNS)


class _ForEach(Decorator):
    """Runs its child once per item, in order; none for an empty list. Fails as soon as the child does.

    py_trees' own ticks its child once for an empty list and stops at an item None.
    """

    def __init__(self, child: Behaviour, name: str, ports: ForEach) -> None:
        super().__init__(child=child, name=name)
        self.ports = ports
        self.remaining: list[object] = []

    def initialise(self) -> None:
        self.remaining = list(self.ports.items)
        if self.remaining:
            self.ports.item = self.remaining[0]

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
        self.ports.item = self.remaining[0]
        return Status.RUNNING
