"""The ports of an imported tree: as its model declares them, the rest from what its nodes do with values."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from executive.cli.importing.markup import Tag
from executive.cli.importing.nodes import plain
from executive.core import registry
from executive.core.values import (
    FLAG,
    NUMBER,
    TEXT,
    VALUE_TYPE_KIND,
)
from executive.tree.node_type import NodeType
from executive.tree.ports import ITEMS, Direction, PortSpec
from executive.tree.spec import GUARDS

_NAME = re.compile(r"\{\s*([A-Za-z_]\w*)((?:\.\w+)*)\s*\}")
_FOREIGN = {
    **dict.fromkeys(("int", "unsigned", "long", "int64_t", "uint64_t", "size_t"), "integer"),
    **dict.fromkeys(("double", "float"), "number"),
    "bool": "flag",
    "std::string": "text",
    "string": "text",
}
_DIRECTIONS = {"input_port": "in", "output_port": "out", "inout_port": "inout"}


@dataclass
class Use:
    """What a tree's nodes do with one of its values.

    `type` is that of the first port it is given to, `guessed` what a guard takes it for.
    """

    type: str | None = None
    guessed: str | None = None
    read: bool = False
    written: bool = False

    @property
    def direction(self) -> str:
        return "in" if not self.written else "inout" if self.read else "out"


@dataclass
class Uses:
    """Values by name, and those that the tree makes for itself (the items of a for_each)."""

    of: dict[str, Use] = field(default_factory=dict)
    items: set[str] = field(default_factory=set)

    def add(self, name: str, kind: str | None, direction: Direction | None) -> None:
        use = self.of.setdefault(name, Use())
        use.type = use.type or kind
        use.read |= direction is not Direction.OUT
        use.written |= direction in (Direction.OUT, Direction.INOUT)


def uses(node: Any, types: Mapping[str, NodeType], trees: Mapping[str, Mapping[str, Any]]) -> Uses:
    """Every value in a tree's root. `trees` are the ports, as the files declare them, of trees it uses."""
    found = Uses()
    for kind, content, beside in walk(node):
        for word in GUARDS:
            for name, _ in _NAME.findall(str(beside.get(word, ""))):
                found.add(name, None, Direction.IN)
                found.of[name].guessed = found.of[name].guessed or _guessed(beside[word], name)
        for port, item_type in _items(types.get(kind)):
            if isinstance(content.get(port), str):
                found.items.add(content[port])
                found.of.setdefault(content[port], Use()).type = item_type
        for port, value in content.items():
            match = _NAME.fullmatch(value) if isinstance(value, str) else None
            if match is not None:
                type_, direction = _port(kind, port, types, trees)
                found.add(match[1], None if match[2] else type_, direction)
    return found


def _items(kind: NodeType | None) -> Iterator[tuple[str, str]]:
    """The ports of a type of node that name an item for its child, and the item's type."""
    ports = {port.name: port for port in kind.ports} if kind is not None else {}
    for port in ports.values():
        if port.item_of is not None:
            yield port.name, ITEMS[ports[port.item_of].type.name].name


def declared(model: Tag | None) -> dict[str, dict[str, Any]]:
    """The ports that a SubTree of the TreeNodesModel declares, as our files write them."""
    ports: dict[str, dict[str, Any]] = {}
    for tag in model.children if model is not None else []:
        if tag.name in _DIRECTIONS and "name" in tag.attributes:
            ports[tag.attributes["name"]] = _declared(tag)
    return ports


def completed(
    ports: dict[str, dict[str, Any]], found: Uses, given: set[str]
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """The declared ports with types filled in, and those added that callers give or nobody writes.

    Also the names whose type nothing tells; they count as text.
    """
    wanted = [n for n, use in found.of.items() if not use.written and n not in found.items]
    made, untold = {}, []
    for name in dict.fromkeys([*ports, *sorted(given), *wanted]):
        use = found.of.get(name, Use())
        port = {"type": None, "direction": use.direction} | ports.get(name, {})
        if port["type"] not in registry.names(VALUE_TYPE_KIND):
            port["type"] = use.type or use.guessed or TEXT.name
            if use.type is None and use.guessed is None:
                untold.append(name)
        made[name] = port
    return made, untold


def walk(node: Any) -> Iterator[tuple[str, Mapping[str, Any], Mapping[str, Any]]]:
    """(type, ports, what stands beside) of every node."""
    if not isinstance(node, dict):
        return
    kind = next(iter(node))
    content = node[kind]
    children = content if isinstance(content, list) else [content.get("child"), *content.get("children", [])]
    yield kind, {} if isinstance(content, list) else content, node
    for child in children:
        yield from walk(child)


def _guessed(guard: str, name: str) -> str | None:
    """What a guard takes a value for: a number where it is compared or computed with, else a flag."""
    value = rf"\{{\s*{name}\s*\}}"
    if re.search(rf"{value}\s*[=!]=\s*['\"]|['\"]\s*[=!]=\s*{value}", guard):
        return TEXT.name
    computed = rf"{value}\s*[-+*/<>=!]|([-+*/<>=]|(abs|min|max)\([^()]*)\s*{value}"
    if re.search(computed, guard):
        return NUMBER.name
    return FLAG.name if re.search(value, guard) else None


def _port(
    kind: str, port: str, types: Mapping[str, NodeType], trees: Mapping[str, Mapping[str, Any]]
) -> tuple[str | None, Direction | None]:
    """Type and direction of a node's port; None for what nobody declares."""
    if kind in trees:
        declared = trees[kind].get(port, {})
        return declared.get("type"), Direction(declared["direction"]) if "direction" in declared else None
    specs: tuple[PortSpec, ...] = types[kind].ports if kind in types else ()
    spec = next((s for s in specs if s.name == port), None)
    return (spec.type.name, spec.direction) if spec else (None, None)


def _declared(tag: Tag) -> dict[str, Any]:
    given = tag.attributes.get("type", "")
    kind = given if given in registry.names(VALUE_TYPE_KIND) else _FOREIGN.get(given)
    port: dict[str, Any] = {"type": kind, "direction": _DIRECTIONS[tag.name]}
    if "default" in tag.attributes:
        port["default"] = plain(tag.attributes["default"], kind or TEXT.name)
    words = " ".join(tag.text.split())
    return port | ({"doc": words} if words else {})
