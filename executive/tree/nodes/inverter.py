"""No for yes, and yes for no."""

from __future__ import annotations

from collections.abc import Sequence

from py_trees import decorators
from py_trees.behaviour import Behaviour

from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities, any_of, only, where
from executive.tree.groot import Groot
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.order import Child, Ends, Known, in_turn


class Inverter(ControlNode):
    """Success for failure, and failure for success."""

    symbol = "¬"
    children = Children.ONE
    groot = Groot("Inverter")

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        return decorators.Inverter(context.name, child)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        return only(able, RUNS) | where(SUCCEEDS in able, FAILS) | where(FAILS in able, SUCCEEDS)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        ends = in_turn(before, children, until=False)
        return Ends(ends.failed, ends.succeeded)
