"""Again, after a failure."""

from __future__ import annotations

from collections.abc import Sequence

from py_trees import decorators
from py_trees.behaviour import Behaviour

from executive.core.values import INTEGER
from executive.tree.abilities import FAILS, RUNS, Abilities, any_of, where
from executive.tree.groot import Attribute, Groot
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.ports import In


class Retry(ControlNode):
    """Run the child again when it fails."""

    symbol = "↻"
    children = Children.ONE
    groot = Groot("RetryUntilSuccessful", {"attempts": Attribute("num_attempts")})

    attempts = In[int](INTEGER, "the most times to try", fixed=True, least=1)

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        (child,) = children
        return decorators.Retry(context.name, child, self.attempts)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        return able | where(FAILS in able, RUNS)
