"""The control node: what has children, and decides which of them is ticked and what their ends come to.

    class Majority(ControlNode):
        '''Run the children in turn; end as more than half of them did.'''

        symbol = "½"

        def make(self, children, context):
            return _Majority(context.name, children)

One class in one file is all there is to write: checks, schema, catalogue, drawings, Groot2, coverage and
mutation read its declarations. A decorator is the case with one child.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ClassVar

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.values import ValueType
from executive.tree.abilities import Abilities, any_of
from executive.tree.declared import Declared
from executive.tree.nodes.services import Services
from executive.tree.order import Child, Ends, Known, in_turn
from executive.tree.store import Binding
from executive.tree.trace import Trace


class Children(StrEnum):
    """How many children a node has."""

    NONE = "none"
    ONE = "one"
    TWO = "two"
    MANY = "many"


@dataclass(frozen=True)
class NodeContext:
    """What a control node is made with: where it stands, and what the tree around it has.

    `value` gives the tree's own value of a name and type (a constant None where it has none); `strategies`
    makes an instance of every strategy that the tree can give its ports to, by name.
    """

    name: str
    path: str
    trace: Trace
    services: Services
    value: Callable[[str, ValueType[Any]], Binding]
    strategies: Callable[[], Mapping[str, Behaviour]]


class ControlNode(Declared, ABC):
    """A type of control node. An instance is one node of a tree, its ports bound: `self.attempts`.

    `roles` says what each of TWO children is for; `skipped` is what a child counts as whose `skip_if` holds.
    `recovers` marks one that runs strategies beside its children. `counterpart` is the type that people
    write by mistake in its place; mutation tests put it there.
    """

    children: ClassVar[Children] = Children.MANY
    roles: ClassVar[tuple[str, ...]] = ()
    skipped: ClassVar[Status] = Status.SUCCESS
    recovers: ClassVar[bool] = False
    counterpart: ClassVar[str | None] = None

    def __init__(self, bindings: Mapping[str, Binding]) -> None:
        self.bindings = bindings

    @abstractmethod
    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        """The py_trees behaviour of this node over those of its children."""

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        """How the node can end, from how each child can; only `fixed` ports are known here.

        By default it passes on what its children do.
        """
        return any_of(inside)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        """Which values are certain to be set after it, from those that are before it.

        By default the children are taken to run in turn, and to be all there is; go through each with what is
        certain when it is entered first.
        """
        return in_turn(before, children, until=False)

    def interrupts(self, index: int, count: int) -> bool:
        """Whether child `index` of `count` may be ended by this node, or for a sibling, while under way."""
        return False
