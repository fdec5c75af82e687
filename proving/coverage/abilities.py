"""How a node can end at all, by what its type declares and by what is inside it."""

from __future__ import annotations

from collections.abc import Sequence

from executive.core.types import Reason
from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities, any_of
from executive.tree.nodes.leaf import Leaf
from executive.tree.spec import NodeSpec


def of_leaf(leaf: type[Leaf]) -> Abilities:
    """By the leaf's declared outcomes."""
    ends = {SUCCEEDS if reason is Reason.DONE else FAILS for reason in leaf.outcomes}
    return frozenset(ends | ({RUNS} if leaf.takes_time() else set()))


def of_inner(node: NodeSpec, inside: Sequence[Abilities]) -> Abilities:
    """By the abilities of the children, or of the root of a tree used as a node."""
    control = node.control
    return any_of(inside) if control is None else control.abilities(inside)


def guarded(node: NodeSpec, able: Abilities, skipped: str) -> Abilities:
    """With what the node's guards add; `skipped` is how a skipped node counts where it stands."""
    added = {"while": FAILS, "failure_if": FAILS, "success_if": SUCCEEDS, "skip_if": skipped}
    return able | {added[word] for word in node.guards}
