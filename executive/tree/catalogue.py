"""The node types a tree file can use: the built-in composites and decorators, and the leaves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from executive.core.values import (
    DURATION,
    FLAG,
    INTEGER,
    ROUTE,
    SEGMENT,
    TEXT,
    ValueType,
)
from executive.tree.nodes.base import (
    REQUIRED,
    Direction,
    Leaf,
    PortSpec,
)
from executive.tree.nodes.kind import Leaves, leaves


@dataclass(frozen=True)
class NodeType:
    """A type of node. `children` is none, one, two or many; `fixed` ports take literals only.

    `choices` lists the words that a text port takes.
    """

    name: str
    category: str
    doc: str
    ports: tuple[PortSpec, ...] = ()
    children: str = "none"
    fixed: frozenset[str] = frozenset()
    choices: Mapping[str, tuple[str, ...]] | None = None


ITEMS: dict[str, ValueType[Any]] = {ROUTE.name: SEGMENT}
"""What the items of a list type are."""


def _in(name: str, kind: ValueType[Any], help: str, default: object = REQUIRED) -> PortSpec:
    return PortSpec(name, kind, Direction.IN, help, default)


_MEMORY = _in("memory", FLAG, "go on with the child that was running, instead of starting anew", True)
_ATTEMPTS = _in("attempts", INTEGER, "how often at most")

BUILTINS: dict[str, NodeType] = {
    node.name: node
    for node in (
        NodeType(
            "sequence",
            "control",
            "Run the children in turn until one fails.",
            (_MEMORY,),
            "many",
            frozenset({"memory"}),
        ),
        NodeType(
            "selector",
            "control",
            "Run the children in turn until one succeeds.",
            (_MEMORY,),
            "many",
            frozenset({"memory"}),
        ),
        NodeType(
            "parallel",
            "control",
            "Run the children at once; fail as soon as one fails.",
            (_in("policy", TEXT, "succeed when all or one of the children did", "all"),),
            "many",
            frozenset({"policy"}),
            {"policy": ("all", "one")},
        ),
        NodeType(
            "loop",
            "control",
            "Ask the first child; until it succeeds, run the second and ask again; fail when that fails.",
            (),
            "two",
        ),
        NodeType("inverter", "decorator", "Success for failure, and failure for success.", (), "one"),
        NodeType(
            "retry",
            "decorator",
            "Run the child again when it fails.",
            (_ATTEMPTS,),
            "one",
            frozenset({"attempts"}),
        ),
        NodeType(
            "repeat",
            "decorator",
            "Run the child again when it succeeds; without `times`, for ever.",
            (_in("times", INTEGER, "how often", None),),
            "one",
            frozenset({"times"}),
        ),
        NodeType("force_success", "decorator", "Success however the child ends.", (), "one"),
        NodeType("force_failure", "decorator", "Failure however the child ends.", (), "one"),
        NodeType(
            "timeout",
            "decorator",
            "Fail when the child has not ended after this mission time.",
            (_in("after", DURATION, "mission time the child may take"),),
            "one",
        ),
        NodeType(
            "for_each",
            "decorator",
            "Run the child once for each item, in order, until it fails.",
            (
                _in("in", ROUTE, "the items"),
                _in("as", TEXT, "the name under which the child sees the item"),
            ),
            "one",
            frozenset({"as"}),
        ),
        NodeType(
            "recover",
            "decorator",
            "Run the child; when it fails, let the pool choose a strategy, then run it again.",
            (_ATTEMPTS,),
            "one",
            frozenset({"attempts"}),
        ),
    )
}


def of_leaf(name: str, leaf: type[Leaf]) -> NodeType:
    """A leaf's entry, from its own declaration."""
    doc = (leaf.__doc__ or "").strip().split("\n\n")[0]
    return NodeType(name, "leaf", " ".join(doc.split()), leaf.ports())


def node_types(own: Leaves | None = None) -> dict[str, NodeType]:
    """Everything a tree file can use without another file."""
    return BUILTINS | {name: of_leaf(name, leaf) for name, leaf in (leaves() if own is None else own).items()}
