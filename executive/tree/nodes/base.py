"""All that a node is written with, in one import."""

from __future__ import annotations

from executive.tree.nodes.action import ActionLeaf
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.nodes.ending import EndingDecorator
from executive.tree.nodes.leaf import ErrorsOf, Leaf
from executive.tree.ports import (
    REQUIRED,
    Direction,
    FromTree,
    In,
    InOut,
    Item,
    Out,
    PortSpec,
)
from executive.tree.store import Binding, Constant, Slot, Store
from executive.tree.trace import Trace

__all__ = [
    "REQUIRED",
    "ActionLeaf",
    "Binding",
    "Children",
    "Constant",
    "ControlNode",
    "Direction",
    "EndingDecorator",
    "ErrorsOf",
    "FromTree",
    "In",
    "InOut",
    "Item",
    "Leaf",
    "NodeContext",
    "Out",
    "PortSpec",
    "Slot",
    "Store",
    "Trace",
]
