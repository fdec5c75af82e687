"""A type of node as files speak of it: made from a class, or from another tree used as a node."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from executive.tree.abilities import FAILS, SUCCEEDS
from executive.tree.groot import Groot
from executive.tree.nodes.control import Children, ControlNode
from executive.tree.nodes.leaf import Leaf
from executive.tree.ports import PortSpec
from executive.tree.store import Constant

TREE_SYMBOL, CONDITION_SYMBOL = "⌂", "◇"
NodeClass = type[Leaf] | type[ControlNode]


@dataclass(frozen=True)
class NodeType:
    """`category` is control, decorator, leaf or tree; `leaf` or `control` is its class, trees have none."""

    name: str
    category: str
    doc: str
    ports: tuple[PortSpec, ...] = ()
    leaf: type[Leaf] | None = None
    control: type[ControlNode] | None = None

    @classmethod
    def of(cls, declared: NodeClass) -> NodeType:
        """A class's entry, from its own declaration."""
        name, doc, ports = declared.name, declared.doc(), declared.ports()
        if issubclass(declared, Leaf):
            return cls(name, "leaf", doc, ports, leaf=declared)
        category = "decorator" if declared.children is Children.ONE else "control"
        return cls(name, category, doc, ports, control=declared)

    @property
    def former_names(self) -> tuple[str, ...]:
        declared = self.leaf or self.control
        return declared.former_names if declared else ()

    @property
    def children(self) -> Children:
        return self.control.children if self.control else Children.NONE

    @property
    def symbol(self) -> str:
        """What stands before a node of this type in drawings."""
        declared = self.leaf or self.control
        if declared is None:
            return TREE_SYMBOL
        return declared.symbol or (CONDITION_SYMBOL if self.condition else "")

    @property
    def needs(self) -> tuple[str, ...]:
        """The devices it cannot do without."""
        declared = self.leaf or self.control
        return declared.needs if declared else ()

    @property
    def groot(self) -> Groot:
        """What BehaviorTree.CPP calls it; a node of our own keeps its name."""
        declared = self.leaf or self.control
        return (declared.groot if declared else None) or Groot(self.name)

    @property
    def condition(self) -> bool:
        """Whether it is a question, answered at once."""
        return self.leaf is not None and self.leaf.condition

    @property
    def recovers(self) -> bool:
        """Whether it runs strategies beside its children."""
        return self.control is not None and self.control.recovers

    @property
    def names_an_item(self) -> bool:
        """Whether its child runs for each of several, one after the other."""
        return any(port.item_of for port in self.ports)

    @property
    def bare_child(self) -> bool:
        """Whether its child may stand right under it: `inverter: {facing: ...}`."""
        return self.children is Children.ONE and not self.ports

    @property
    def inverts(self) -> bool:
        """Whether all it does is to turn success and failure round."""
        if not self.bare_child or self.control is None:
            return False
        node, yes, no = self.control({}), frozenset({SUCCEEDS}), frozenset({FAILS})
        return node.abilities([yes]) == no and node.abilities([no]) == yes

    def with_literals(self, values: Mapping[str, object]) -> ControlNode | None:
        """A control node with these values of its ports, to be asked what it can do; None for others."""
        return (
            self.control({name: Constant(value) for name, value in values.items()}) if self.control else None
        )
