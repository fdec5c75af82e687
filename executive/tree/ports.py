"""How a node declares its ports: as class attributes, which checks, schema and catalogue read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ClassVar, Generic, Protocol, TypeVar, overload

from executive.core.types import Outcome, Reason
from executive.core.values import ROUTE, SEGMENT, TEXT, ValueType
from executive.tree.store import Binding

T = TypeVar("T")

ITEMS: dict[str, ValueType[Any]] = {ROUTE.name: SEGMENT}
"""What the items of a list type are."""


class Direction(StrEnum):
    IN = "in"
    OUT = "out"
    INOUT = "inout"


@dataclass(frozen=True)
class FromTree:
    """A default that means: the tree's own value of this name, if the tree has one (else None)."""

    name: str


class _Required:
    def __repr__(self) -> str:
        return "required"


REQUIRED = _Required()


@dataclass(frozen=True)
class PortSpec:
    """One declared port, as the catalogue shows it. `default` is REQUIRED, FromTree or a value.

    `choices` are the words that a text port takes; a `fixed` port takes literals only; a whole number is
    `least` or more. Where `item_of` names a port, this one takes the name under which the child sees one
    item of that port's list after the other.
    """

    name: str
    type: ValueType[Any]
    direction: Direction
    help: str
    default: object = REQUIRED
    choices: tuple[str, ...] = ()
    fixed: bool = False
    least: int | None = None
    item_of: str | None = None

    @property
    def may_be_unset(self) -> bool:
        """Whether a node can do without a value for it."""
        return self.default is None or isinstance(self.default, FromTree)


class Bound(Protocol):
    """What has ports: each name bound to a literal or to a place in the tree's store."""

    @property
    def bindings(self) -> Mapping[str, Binding]: ...


class PortError(Exception):
    """A port cannot give its node a value; the node ends with this reason, as it does with any other."""

    def __init__(self, reason: Reason, detail: str) -> None:
        super().__init__(detail)
        self.outcome: Outcome[object] = Outcome(reason, detail)


class Port(Generic[T]):
    """A declared port; on an instance, its value. Its name is the attribute's unless `name` gives another."""

    direction: ClassVar[Direction]
    item_of: str | None = None

    def __init__(
        self,
        type: ValueType[T],
        help: str,
        default: object = REQUIRED,
        *,
        name: str = "",
        choices: tuple[str, ...] = (),
        fixed: bool = False,
        least: int | None = None,
    ) -> None:
        self.type, self.help, self.default = type, help, default
        self.name, self.choices, self.fixed, self.least = name, choices, fixed, least

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = self.name or name

    @overload
    def __get__(self, node: None, owner: type) -> Port[T]: ...
    @overload
    def __get__(self, node: Bound, owner: type) -> T: ...
    def __get__(self, node: Bound | None, owner: type) -> Port[T] | T:
        if node is None:
            return self
        binding = node.bindings[self.name]
        value: T = binding.read()
        if value is None and self.direction is not Direction.OUT and not self.may_be_unset:
            raise PortError(Reason.UNSET, f"port {self.name}: {binding} is not set yet")
        if self.choices and value not in self.choices:  # a reference may bring anything
            expected = ", ".join(self.choices)
            raise PortError(Reason.GUARD, f"port {self.name}: got {value!r}, expected one of {expected}")
        return value

    @property
    def may_be_unset(self) -> bool:
        """Whether a node of this port can do without a value."""
        return self.default is None or isinstance(self.default, FromTree)

    def spec(self) -> PortSpec:
        return PortSpec(
            self.name,
            self.type,
            self.direction,
            self.help,
            self.default,
            self.choices,
            self.fixed,
            self.least,
            self.item_of,
        )


class In(Port[T]):
    """A port that the node reads."""

    direction = Direction.IN


class WrittenPort(Port[T]):
    """A port that can be assigned to."""

    def __set__(self, node: Bound, value: T) -> None:
        node.bindings[self.name].write(value)


class Out(WrittenPort[T]):
    """A port that the node writes."""

    direction = Direction.OUT


class InOut(WrittenPort[T]):
    """A port that the node reads and writes."""

    direction = Direction.INOUT


class Item(WrittenPort[Any]):
    """A port that takes a name: the child sees one item of the list port `of` under it after the other.

    The node writes the item by assigning to the port.
    """

    direction = Direction.IN

    def __init__(self, help: str, of: str, *, name: str = "") -> None:
        super().__init__(TEXT, help, name=name, fixed=True)
        self.item_of = of


def declared_ports(cls: type) -> tuple[PortSpec, ...]:
    """The ports that a class declares, in order of declaration, base classes first."""
    found: dict[str, PortSpec] = {}
    for base in reversed(cls.__mro__):
        for attribute in vars(base).values():
            if isinstance(attribute, Port):
                found[attribute.name] = attribute.spec()
    return tuple(found.values())
