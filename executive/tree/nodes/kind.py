"""The kind of leaf that a tree file can use by name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from executive.core import registry
from executive.core.registry import Kind
from executive.core.types import Reason
from executive.tree.nodes.base import Leaf

Leaves = Mapping[str, type[Leaf]]


def leaves() -> dict[str, type[Leaf]]:
    """Every leaf that can be used, by the name that tree files call it."""
    return registry.every(LEAF_KIND)


def leaf_name(leaf: type[Leaf]) -> str:
    """What a leaf is called where nobody says otherwise: `WaitForDawn` is wait_for_dawn."""
    return registry.own_name(leaf) or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", leaf.__name__).lower()


def broken_promises(leaf: type[Leaf]) -> Iterator[str]:
    """What a leaf's declaration lacks."""
    if not (leaf.__doc__ or "").strip() or leaf.__doc__ == Leaf.__doc__:
        yield "it does not say what it does (a docstring)"
    if leaf.step is Leaf.step:
        yield "it has no step()"
    if not leaf.outcomes or not all(isinstance(reason, Reason) for reason in leaf.outcomes):
        yield f"its outcomes are reasons, got {leaf.outcomes!r}"
    for port in leaf.ports():
        if not port.help:
            yield f"its port {port.name} does not say what it is for"


LEAF_KIND: Kind[type[Leaf]] = Kind(
    "leaf",
    "leaves",
    "A node that acts or asks, by its name in tree files.",
    Leaf,
    classes=True,
    check=broken_promises,
    name_of=leaf_name,
)
