"""How a node can end at all, by its kind and by what is inside it: success, failure, running."""

from __future__ import annotations

from collections.abc import Sequence
from types import NoneType
from typing import get_args, get_type_hints

from executive.core.types import Reason
from executive.tree.nodes.base import Leaf
from executive.tree.nodes.kind import leaves
from executive.tree.spec import NodeSpec

Abilities = frozenset[str]
S, F, R = "success", "failure", "running"
NONE: Abilities = frozenset()


def leaf_class(node: NodeSpec) -> type[Leaf] | None:
    """The class of a leaf, None for any other node."""
    return leaves().get(node.type) if node.category == "leaf" else None


def takes_time(leaf: type[Leaf]) -> bool:
    """Whether a step may leave the leaf under way, as the type of what it returns says."""
    return NoneType in get_args(get_type_hints(leaf.step)["return"])


def of_leaf(leaf: type[Leaf]) -> Abilities:
    """By the leaf's declared outcomes."""
    ends = {S if reason is Reason.DONE else F for reason in leaf.outcomes}
    return frozenset(ends | ({R} if takes_time(leaf) else set()))


def of_inner(node: NodeSpec, inside: Sequence[Abilities]) -> Abilities:
    """By the abilities of the children, or of the root of a tree used as a node."""
    some = NONE.union(*inside)
    every = frozenset.intersection(*inside) if inside else NONE
    able: Abilities = some & {R}
    match node.type:
        case "sequence":
            return able | (every & {S}) | (some & {F})
        case "selector":
            return able | (some & {S}) | (every & {F})
        case "parallel":
            succeeds = some if node.literal("policy") == "one" else every
            return able | (succeeds & {S}) | (some & {F})
        case "loop":
            return _of_loop(*inside)
        case "inverter":
            return able | ({F} if S in some else NONE) | ({S} if F in some else NONE)
        case "force_success":
            return able | {S}
        case "force_failure":
            return able | {F}
        case "retry" | "recover":
            return some | ({R} if F in some else NONE)
        case "repeat":
            ends = some if node.literal("times") is not None else some - {S}
            return ends | ({R} if S in some else NONE)
        case "timeout":
            return some | ({F} if R in some else NONE)
        case "for_each":
            return some | {S} | ({R} if S in some else NONE)
        case _:
            return some


def guarded(node: NodeSpec, able: Abilities, skipped: str) -> Abilities:
    """With what the node's guards add; `skipped` is how a skipped node counts where it stands."""
    added = {"while": F, "failure_if": F, "success_if": S, "skip_if": skipped}
    return able | {added[word] for word in node.guards}


def _of_loop(until: Abilities, do: Abilities) -> Abilities:
    goes_on = F in until and S in do  # the question is asked again in a later tick
    return (until & {S, R}) | (do & {F, R}) | ({R} if goes_on else NONE)
