"""Again, after a success."""

from __future__ import annotations

from collections.abc import Sequence

from py_trees import decorators
from py_trees.behaviour import Behaviour

from executive.core.values import INTEGER
from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities, any_of, only, where
from executive.tree.groot import Attribute, Groot, Variant
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.order import Child, Ends, Known, in_turn
from executive.tree.ports import In


def _num_cycles(times: object) -> str | None:
    return "-1" if times is None else None


def _times(num_cycles: str, children: int) -> object:
    return None if num_cycles == "-1" else num_cycles


class Repeat(ControlNode):
    """Run the child again when it succeeds; without `times`, for ever."""

    symbol = "⟳"
    children = Children.ONE
    groot = Groot(
        "Repeat",
        {"times": Attribute("num_cycles", _num_cycles, _times)},
        variants={"KeepRunningUntilFailure": Variant()},
    )

    times = In[int | None](INTEGER, "how often", None, fixed=True, least=1)

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        return decorators.Repeat(context.name, child, -1 if self.times is None else self.times)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        ends = able if self.times is not None else only(able, FAILS, RUNS)
        return ends | where(SUCCEEDS in able, RUNS)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        ends = in_turn(before, children, until=False)
        return ends if self.times is not None else Ends(None, ends.failed)
