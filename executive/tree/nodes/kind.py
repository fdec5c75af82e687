"""The two kinds of node that can be added: leaves, and control nodes with decorators."""

from __future__ import annotations

from collections.abc import Iterator

from executive.core.registry import Kind
from executive.core.types import Reason
from executive.tree.declared import Declared
from executive.tree.nodes.control import Children, ControlNode
from executive.tree.nodes.leaf import Leaf
from executive.tree.ports import ITEMS


def broken_promises(leaf: type[Leaf]) -> Iterator[str]:
    """What a leaf's declaration lacks."""
    yield from _of_declaration(leaf, Leaf)
    if leaf.step is Leaf.step:
        yield "it has no step()"
    if not leaf.outcomes or not all(isinstance(reason, Reason) for reason in leaf.outcomes):
        yield f"its outcomes are reasons, got {leaf.outcomes!r}"
    if leaf.condition and leaf.takes_time():
        yield "it is a condition, but its step() may return None"


def broken_promises_of_control(node: type[ControlNode]) -> Iterator[str]:
    """What a control node's declaration lacks."""
    yield from _of_declaration(node, ControlNode)
    if node.children not in (Children.ONE, Children.TWO, Children.MANY):
        yield f"its children are ONE, TWO or MANY, got {node.children!r}"
    if node.roles and node.children is not Children.TWO:
        yield "it has roles, which two children have"
    ports = {port.name: port for port in node.ports()}
    for port in ports.values():
        if port.item_of is not None and (
            port.item_of not in ports or ports[port.item_of].type.name not in ITEMS
        ):
            yield f"its port {port.name} takes items of {port.item_of}, which is no port with a list"


def _of_declaration(node: type[Declared], base: type[Declared]) -> Iterator[str]:
    if not (node.__doc__ or "").strip() or node.__doc__ == base.__doc__:
        yield "it does not say what it does (a docstring)"
    for port in node.ports():
        if not port.help:
            yield f"its port {port.name} does not say what it is for"


def _name(node: type[Declared]) -> str:
    return node.name


def _former_names(node: type[Declared]) -> tuple[str, ...]:
    return node.former_names


LEAF_KIND: Kind[type[Leaf]] = Kind(
    "leaf",
    "leaves",
    "A node that acts or asks, by its name in tree files.",
    Leaf,
    classes=True,
    check=broken_promises,
    name_of=_name,
    former_names_of=_former_names,
)
CONTROL_KIND: Kind[type[ControlNode]] = Kind(
    "control node",
    "control_nodes",
    "A node with children, by its name in tree files: control flow and decorators.",
    ControlNode,
    classes=True,
    check=broken_promises_of_control,
    name_of=_name,
    former_names_of=_former_names,
)
