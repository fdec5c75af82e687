"""One child after the other, all of them."""

from __future__ import annotations

from collections.abc import Sequence as Listed

from py_trees import composites
from py_trees.behaviour import Behaviour

from executive.core.values import FLAG
from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities, all_of, any_of, only
from executive.tree.groot import Groot, Variant
from executive.tree.nodes.control import ControlNode, NodeContext
from executive.tree.ports import In


class Sequence(ControlNode):
    """Run the children in turn until one fails."""

    symbol = "→"
    counterpart = "selector"
    groot = Groot(
        "Sequence",
        variants={
            "ReactiveSequence": Variant(
                {"memory": False}, True, "a sequence without memory: it starts anew at every tick"
            ),
            "AsyncSequence": Variant(
                note="a plain sequence: it does not wait for a tick between its children"
            ),
        },
    )

    memory = In[bool](
        FLAG, "go on with the child that was running, instead of starting anew", True, fixed=True
    )

    def make(self, children: Listed[Behaviour], context: NodeContext) -> Behaviour:
        return composites.Sequence(context.name, self.memory, list(children))

    def abilities(self, inside: Listed[Abilities]) -> Abilities:
        able = any_of(inside)
        return only(able, RUNS, FAILS) | only(all_of(inside), SUCCEEDS)

    def interrupts(self, index: int, count: int) -> bool:
        return index > 0 and not self.memory
