"""BehaviorTree.CPP v4 XML, as Groot2 reads it, with a TreeNodesModel of everything used."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping

from executive.core.units import written
from executive.tree.catalogue import NodeType, node_types
from executive.tree.nodes.base import REQUIRED, FromTree, PortSpec
from executive.tree.spec import Literal, NodeSpec, TreeSpec

NAMES = {
    "sequence": "Sequence",
    "selector": "Fallback",
    "parallel": "Parallel",
    "inverter": "Inverter",
    "retry": "RetryUntilSuccessful",
    "repeat": "Repeat",
    "force_success": "ForceSuccess",
    "force_failure": "ForceFailure",
    "timeout": "Timeout",
}
REACTIVE = {"sequence": "ReactiveSequence", "selector": "ReactiveFallback"}
GUARDS = {"skip_if": "_skipIf", "while": "_while", "success_if": "_successIf", "failure_if": "_failureIf"}


def groot(tree: TreeSpec, strategies: Mapping[str, TreeSpec] | None = None) -> str:
    """The tree and every tree inside it. Strategies become trees of their own, which nothing refers to.

    Own nodes (for_each, recover, leaves) are declared in the model, so that Groot2 shows their ports.
    """
    root = ET.Element("root", {"BTCPP_format": "4", "main_tree_to_execute": tree.name})
    trees = {t.name: t for top in (tree, *(strategies or {}).values()) for t in _trees(top)}
    for one in trees.values():
        about = {"_description": one.doc} if one.doc else {}
        ET.SubElement(root, "BehaviorTree", {"ID": one.name, **about}).append(_node(one.root))
    model = ET.SubElement(root, "TreeNodesModel")
    for kind in _own_kinds(trees.values()):
        model.append(_model(kind))
    for one in trees.values():
        model.append(_ports(ET.Element("SubTree", {"ID": one.name}), one.ports))
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _trees(tree: TreeSpec) -> Iterator[TreeSpec]:
    yield tree
    stack = [tree.root]
    while stack:
        node = stack.pop()
        stack.extend(node.children)
        if node.tree is not None:
            yield from _trees(node.tree)


def _node(node: NodeSpec) -> ET.Element:
    attributes = {"name": node.name} if node.name != node.type else {}
    attributes |= {_port_name(node.type, port): _port_text(node, port) for port in node.ports}
    attributes |= {GUARDS[word]: guard.text for word, guard in node.guards.items()}
    if node.tree is not None:
        return ET.Element("SubTree", {"ID": node.tree.name} | attributes)
    element = ET.Element(_tag(node), {k: v for k, v in attributes.items() if k != "memory"})
    if node.type == "parallel":
        del element.attrib["policy"]
        element.set("success_count", "-1" if node.literal("policy") == "all" else "1")
        element.set("failure_count", "1")
    element.extend(_node(child) for child in node.children)
    return element


def _tag(node: NodeSpec) -> str:
    if node.type in REACTIVE and not node.literal("memory"):
        return REACTIVE[node.type]
    return NAMES.get(node.type, node.type)


def _port_name(kind: str, port: str) -> str:
    renamed = {
        ("retry", "attempts"): "num_attempts",
        ("repeat", "times"): "num_cycles",
        ("timeout", "after"): "msec",
    }
    return renamed.get((kind, port), port)


def _port_text(node: NodeSpec, port: str) -> str:
    value = node.ports[port]
    if node.type == "timeout" and isinstance(value, Literal) and isinstance(value.value, float):
        return str(round(value.value * 1000))
    if node.type == "repeat" and isinstance(value, Literal) and value.value is None:
        return "-1"
    return str(value)


def _own_kinds(trees: Iterable[TreeSpec]) -> Iterator[NodeType]:
    used: set[str] = set()
    for tree in trees:
        stack = [tree.root]
        while stack:
            node = stack.pop()
            stack.extend(node.children)
            used.add(node.type)
    for name, kind in node_types().items():
        if name in used and name not in NAMES:
            yield kind


def _model(kind: NodeType) -> ET.Element:
    tag = {"control": "Control", "decorator": "Decorator"}.get(kind.category, "Action")
    return _ports(ET.Element(tag, {"ID": kind.name}), kind.ports)


def _default_text(port: PortSpec) -> str:
    """A default as a tree file would give it: dimensioned numbers with their unit."""
    if isinstance(port.default, bool):
        return str(port.default).lower()
    if port.type.unit is not None and isinstance(port.default, float):
        return written(port.default, port.type.unit)
    return str(port.default)


def _ports(element: ET.Element, ports: tuple[PortSpec, ...]) -> ET.Element:
    tags = {"in": "input_port", "out": "output_port", "inout": "inout_port"}
    for port in ports:
        attributes = {"name": port.name, "type": port.type.name}
        if isinstance(port.default, FromTree):
            attributes["default"] = f"{{{port.default.name}}}"
        elif port.default is not REQUIRED and port.default is not None:
            attributes["default"] = _default_text(port)
        ET.SubElement(element, tags[port.direction.value], attributes).text = port.help
    return element
