"""Success, whatever happens."""

from __future__ import annotations

from collections.abc import Sequence

from py_trees import decorators
from py_trees.behaviour import Behaviour

from executive.tree.abilities import RUNS, SUCCEEDS, Abilities, any_of, only, where
from executive.tree.groot import Groot
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.order import Child, Ends, Known, both, in_turn


class ForceSuccess(ControlNode):
    """Success however the child ends."""

    symbol = "✓"
    children = Children.ONE
    groot = Groot("ForceSuccess")

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        return decorators.FailureIsSuccess(context.name, child)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        return only(any_of(inside), RUNS) | where(True, SUCCEEDS)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        ends = in_turn(before, children, until=False)
        return Ends(both(ends.succeeded, ends.failed), None)
