"""The pages of the tree language: expressions with their edge cases, and every node with an example."""

from __future__ import annotations

from itertools import groupby
from typing import Any

from executive.cli.reference.prose import examples, prose
from executive.cli.reference.words import cell, quantity
from executive.core import registry
from executive.core.values import VALUE_TYPE_KIND
from executive.run.catalogue import entries
from executive.tree.catalogue import node_types
from executive.tree.node_type import NodeType

_KINDS = {
    "composite": "Nodes with several children",
    "decorator": "Nodes with one child",
    "condition": "Conditions",
    "leaf": "Leaves that act",
}
_FACTORS = {"angle": ("deg", 57.29577951308232), "length": ("m", 1.0), "duration": ("s", 1.0)}
_FACTORS |= {"force": ("N", 1.0), "speed": ("m/s", 1.0), "current": ("A", 1.0)}


def tree_page() -> str:
    """Files, ports, references, guards, expressions, units."""
    rows = [
        f"| `{cell(e['write'])}` | {cell(_with(e.get('with', {})))} | {e['is']} | {cell(e.get('why', ''))} |"
        for e in examples("expressions")
    ]
    head = ["| expression | with | is | |", "|---|---|---|---|"]
    return "\n".join([prose("tree"), *head, *rows, "", "## Types of values\n", *_types(), "", prose("units")])


def _with(values: dict[str, Any]) -> str:
    return ", ".join(
        f"`{name}` {'unset' if value is None else f'= {value}'}" for name, value in values.items()
    )


def _types() -> list[str]:
    lines = ["| type | written | may be asked for |", "|---|---|---|"]
    for name, kind in registry.every(VALUE_TYPE_KIND).items():
        asked = ", ".join(f"`{attribute}`" for attribute in kind.attributes)
        literal = f"a literal{f' in {kind.unit}' if kind.unit else ''}"
        written = literal if kind.literal else "by reference only"

        lines.append(f"| `{name}` | {written} | {asked or '–'} |")
    return lines


def nodes_page() -> str:
    """Every node, by what it is."""
    types = node_types()
    order = list(_KINDS)
    named = sorted((order.index(_kind(node)), name) for name, node in types.items())
    lines = ["# Nodes\n", "Every node that a tree can be built with: what it does, its ports, an example.\n"]
    pages = entries("nodes")
    for kind, group in groupby(named, key=lambda pair: pair[0]):
        lines.append(f"## {_KINDS[order[kind]]}\n")
        for _, name in group:
            lines += _node(name, types[name], pages[name])
    return "\n".join(lines)


def _kind(node: NodeType) -> str:
    if node.leaf is not None:
        return "condition" if node.condition else "leaf"
    return "decorator" if node.children.value == "one" else "composite"


def _node(name: str, node: NodeType, page: dict[str, Any]) -> list[str]:
    lines = [f"### `{name}`\n", f"{_whole_doc(node)}\n"]
    if page["ports"]:
        lines += ["| port | type | | default | |", "|---|---|---|---|---|"]
        lines += [_port(port) for port in page["ports"]]
        lines.append("")
    facts = _facts(node, page)
    lines += [f"{facts}\n"] if facts else []
    if name in examples("nodes"):
        lines.append(f"```yaml\n{examples('nodes')[name].rstrip()}\n```\n")
    return lines


def _whole_doc(node: NodeType) -> str:
    kind = node.leaf or node.control
    text = (kind.__doc__ if kind is not None else "") or node.doc
    return "\n".join(line.strip() for line in text.strip().splitlines())


def _port(port: dict[str, Any]) -> str:
    default = "required" if port["required"] else _default(port)
    choices = port.get("choices")
    kind = " or ".join(f"`{choice}`" for choice in choices) if choices else f"`{port['type']}`"
    return f"| `{port['name']}` | {kind} | {port['direction']} | {default} | {cell(port['help'])} |"


def _default(port: dict[str, Any]) -> str:
    value = port.get("default")
    if value is None:
        return ""
    if isinstance(value, float) and port["type"] in _FACTORS:
        return f"`{quantity(value, *_FACTORS[port['type']])}`"
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


def _facts(node: NodeType, page: dict[str, Any]) -> str:
    facts = []
    if page["needs"]:
        facts.append(f"Needs: {', '.join(page['needs'])}.")
    if node.leaf is not None:
        facts.append(f"Ends with: {', '.join(f'`{reason}`' for reason in node.leaf.outcomes)}.")
    return " ".join(facts)
