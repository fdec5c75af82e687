"""Go through the nodes of a tree in the order in which they run, with what is certain to be set."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial

from executive.core.errors import Problem
from executive.core.types import Reason
from executive.tree.order import Early, Ends, Known, TreeOrder, both, first_of_each
from executive.tree.ports import Direction, FromTree, PortSpec
from executive.tree.spec import NodeSpec, Reference


def order_of(root: NodeSpec, ports: tuple[PortSpec, ...]) -> tuple[TreeOrder, tuple[Problem, ...]]:
    """What a tree with these ports needs and sets, and every place where it reads too early."""
    given = {port.name for port in ports if port.direction is not Direction.OUT}
    through = _Through(given)
    ends = through.node(root, frozenset())
    return TreeOrder(frozenset(through.needs), ends.succeeded), tuple(first_of_each(through.early))


class _Through:
    """One walk. `given` are the names that come from outside, `needs` those of them that were read unset."""

    def __init__(self, given: Collection[str]) -> None:
        self.given = given
        self.needs: set[str] = set()
        self.early: list[Early] = []

    def read(self, early: Early, known: Known) -> None:
        if early.name in known:
            return
        if early.name in self.given:
            self.needs.add(early.name)
        else:
            self.early.append(early)

    def node(self, node: NodeSpec, before: Known) -> Ends:
        """A node with its guards: under one that lets it pass, nothing in it is certain to have run."""
        for word, guard in node.guards.items():
            for offset, name, attributes in guard.body.references:
                words = str(Reference(name, attributes))
                self.read(Early(name, words, node.mark_of(word), offset), before)
        ends = self.bare(node, before)
        passes = before if {"skip_if", "success_if"} & node.guards.keys() else None
        fails = before if node.guards else None
        return Ends(both(ends.succeeded, passes), both(ends.failed, fails))

    def bare(self, node: NodeSpec, before: Known) -> Ends:
        for early in reads(node):
            self.read(early, before)
        if node.tree is not None:
            done = set_by_tree(node)
            return Ends(None if done is None else before | done, before)
        if node.kind.leaf is not None:
            never = Reason.DONE not in node.kind.leaf.outcomes
            return Ends(None if never else before | set(written(node)), before)
        control = node.control
        if control is None:
            return Ends(before, before)
        items = {str(node.ports[port.name]) for port in node.kind.ports if port.item_of in node.ports}
        children = [partial(self.node, child) for child in node.children]
        return control.certain(before | items, children)


def reads(node: NodeSpec) -> Iterator[Early]:
    """The names that the ports of a node cannot do without when it is entered."""
    for port in node.kind.ports:
        if not _is_needed(node, port):
            continue
        value = node.ports.get(port.name)
        if isinstance(value, Reference):
            yield Early(value.name, str(value), node.mark_of(port.name))
        elif value is None and isinstance(port.default, FromTree):
            yield Early(port.default.name, f"{{{port.default.name}}}", node.mark)
        elif value is None and port.default is None:
            yield Early(f"{node.type}.{port.name}", f'no "{port.name}" for {node.type}', node.mark)


def _is_needed(node: NodeSpec, port: PortSpec) -> bool:
    if node.tree is not None:
        return port.name in node.tree.order.needs
    return port.direction is not Direction.OUT and not port.may_be_unset


def written(node: NodeSpec) -> Iterator[str]:
    """The names that a leaf sets when it succeeds."""
    for port in node.kind.ports:
        value = node.ports.get(port.name)
        if port.direction is not Direction.IN and isinstance(value, Reference):
            yield value.name


def set_by_tree(node: NodeSpec) -> Known | None:
    """The names that are certain to be set when the tree used by this node has succeeded; None: it cannot."""
    if node.tree is None or node.tree.order.sets is None:
        return None
    sets = node.tree.order.sets
    return frozenset(
        value.name for port, value in node.ports.items() if port in sets and isinstance(value, Reference)
    )
