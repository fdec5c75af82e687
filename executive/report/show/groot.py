"""BehaviorTree.CPP v4 XML, as Groot2 reads it, with a TreeNodesModel of everything used."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping

from executive.core.units import written
from executive.tree.groot import Attribute
from executive.tree.node_type import NodeType
from executive.tree.ports import REQUIRED, FromTree, PortSpec
from executive.tree.spec import Literal, NodeSpec, TreeSpec

GUARDS = {"skip_if": "_skipIf", "while": "_while", "success_if": "_successIf", "failure_if": "_failureIf"}


def groot(tree: TreeSpec, strategies: Mapping[str, TreeSpec] | None = None) -> str:
    """The tree and every tree inside it. Strategies become trees of their own, which nothing refers to.

    Nodes that BehaviorTree.CPP does not have are declared in the model, so that Groot2 shows their ports.
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
    named = {"name": node.name} if node.name != node.type else {}
    guards = {GUARDS[word]: guard.text for word, guard in node.guards.items()}
    if node.tree is not None:
        ports = {name: str(value) for name, value in node.ports.items()}
        return ET.Element("SubTree", {"ID": node.tree.name} | named | ports | guards)
    declared = node.kind.groot
    ports = dict(_port(node, name) for name in node.ports if name not in declared.told_by_tag)
    constants = {name: value for name, (value, _) in declared.constants.items()}
    element = ET.Element(declared.written_as(node.literals), named | ports | constants | guards)
    element.extend(_node(child) for child in node.children)
    return element


def _port(node: NodeSpec, name: str) -> tuple[str, str]:
    """The attribute that stands for a port, and its text."""
    attribute, value = node.kind.groot.attributes.get(name, Attribute(name)), node.ports[name]
    text = attribute.write(value.value) if isinstance(value, Literal) else None
    return attribute.name, str(value) if text is None else text


def _own_kinds(trees: Iterable[TreeSpec]) -> Iterable[NodeType]:
    """The types used that BehaviorTree.CPP does not have, in a stable order."""
    used: dict[str, NodeType] = {}
    for tree in trees:
        stack = [tree.root]
        while stack:
            node = stack.pop()
            stack.extend(node.children)
            if node.tree is None and node.kind.groot.tag == node.type:
                used[node.type] = node.kind
    return [used[name] for name in sorted(used)]


def _model(kind: NodeType) -> ET.Element:
    leaf = "Condition" if kind.condition else "Action"
    tag = {"control": "Control", "decorator": "Decorator"}.get(kind.category, leaf)
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
