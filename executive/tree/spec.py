"""A tree as read from files: everything checked, nothing instantiated. Drawings are made from it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from executive.config.source import Mark
from executive.core.values import ValueType
from executive.tree.expressions.guards import Guard
from executive.tree.node_type import NodeType
from executive.tree.nodes.control import ControlNode
from executive.tree.order import TreeOrder
from executive.tree.ports import REQUIRED, PortSpec


@dataclass(frozen=True)
class Reference:
    """`{segment.end}`: a value of the tree, and attributes of it."""

    name: str
    attributes: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "{" + ".".join((self.name, *self.attributes)) + "}"


@dataclass(frozen=True)
class Literal:
    """A value given in the file, in SI; `text` is how the file says it."""

    value: object
    text: str = field(default="", compare=False)

    def __str__(self) -> str:
        return self.text or str(self.value)


PortValue = Reference | Literal

GUARDS = ("skip_if", "while", "success_if", "failure_if")
BESIDE = ("name", *GUARDS)
"""What may stand beside a node's type."""


@dataclass(frozen=True)
class NodeSpec:
    """One node of a tree file. `tree` is set where it is another tree."""

    kind: NodeType
    name: str
    mark: Mark
    ports: Mapping[str, PortValue] = field(default_factory=dict)
    guards: Mapping[str, Guard] = field(default_factory=dict)
    children: tuple[NodeSpec, ...] = ()
    tree: TreeSpec | None = None
    marks: Mapping[str, Mark] = field(default_factory=dict)
    """Where the value of each port and guard stands."""

    @property
    def type(self) -> str:
        """What the file calls its type."""
        return self.kind.name

    def mark_of(self, key: str) -> Mark:
        """Where a port or guard stands, or else the node."""
        return self.marks.get(key, self.mark)

    @property
    def literals(self) -> dict[str, object]:
        """The values of the ports that are given literals, in SI."""
        return {name: value.value for name, value in self.ports.items() if isinstance(value, Literal)}

    @property
    def control(self) -> ControlNode | None:
        """The control node with its literals, to be asked what it can do; None for leaves and trees."""
        return self.kind.with_literals(self.literals)


@dataclass(frozen=True)
class TreeSpec:
    """A tree file. `values` are its named values with their types, ports and inner ones."""

    name: str
    doc: str
    file: str
    ports: tuple[PortSpec, ...]
    root: NodeSpec
    values: Mapping[str, ValueType[Any]]
    size: int = 1
    """Nodes in all, sub-trees unfolded."""
    order: TreeOrder = field(default_factory=TreeOrder)


def fits(strategy: TreeSpec, values: Mapping[str, ValueType[Any]]) -> bool:
    """Whether a tree with these values has all that a strategy's tree must be given."""
    return all(
        port.name in values and values[port.name].name == port.type.name
        for port in strategy.ports
        if port.default is REQUIRED
    )


def under(path: str, nodes: tuple[NodeSpec, ...]) -> Iterator[tuple[str, NodeSpec]]:
    """The children of the node at `path` with their paths: names made unique among siblings by #2, #3, ..."""
    seen: dict[str, int] = {}
    for node in nodes:
        seen[node.name] = count = seen.get(node.name, 0) + 1
        yield f"{path}/{node.name}" + (f"#{count}" if count > 1 else ""), node


def root_of(path: str, tree: TreeSpec) -> tuple[str, NodeSpec]:
    """The root node of a tree that stands at `path`, with its own path."""
    return f"{path}/{tree.root.name}", tree.root


def walk(tree: TreeSpec) -> Iterator[tuple[str, NodeSpec]]:
    """Every node with its path, sub-trees unfolded, parents first."""
    stack = [root_of(tree.name, tree)]
    while stack:
        path, node = stack.pop()
        yield path, node
        inner = [root_of(path, node.tree)] if node.tree else list(under(path, node.children))
        stack.extend(reversed(inner))
