"""One child after the other, until one of them succeeds."""

from __future__ import annotations

from collections.abc import Sequence

from py_trees import composites
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.values import FLAG
from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities, all_of, any_of, only
from executive.tree.groot import Groot, Variant
from executive.tree.nodes.control import ControlNode, NodeContext
from executive.tree.order import Child, Ends, Known, in_turn
from executive.tree.ports import In


class Selector(ControlNode):
    """Run the children in turn until one succeeds."""

    symbol = "?"
    skipped = Status.FAILURE
    counterpart = "sequence"
    groot = Groot(
        "Fallback",
        variants={
            "ReactiveFallback": Variant(
                {"memory": False}, True, "a selector without memory: it starts anew at every tick"
            ),
            "AsyncFallback": Variant(
                note="a plain selector: it does not wait for a tick between its children"
            ),
        },
    )

    memory = In[bool](
        FLAG, "go on with the child that was running, instead of starting anew", True, fixed=True
    )

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        return composites.Selector(context.name, self.memory, list(children))

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        return only(able, RUNS, SUCCEEDS) | only(all_of(inside), FAILS)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        return in_turn(before, children, until=True)

    def interrupts(self, index: int, count: int) -> bool:
        return index > 0 and not self.memory
