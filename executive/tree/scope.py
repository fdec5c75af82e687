"""The values of one tree as its nodes see them: by name, by attribute, by default."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from executive.core.values import ValueType, read_attribute
from executive.tree.ports import REQUIRED, Direction, FromTree, PortSpec
from executive.tree.spec import Literal, PortValue
from executive.tree.store import Binding, Constant, Slot, Store


@dataclass(frozen=True)
class Attribute(Slot):
    """A slot's value seen through attributes: `{segment.end}`."""

    kind: ValueType[Any]
    names: tuple[str, ...]

    def read(self) -> Any:
        return read_attribute(self.kind, super().read(), self.names)

    def write(self, value: object) -> None:
        raise TypeError("an attribute of a value cannot be written to")

    def __str__(self) -> str:
        return f"{super().__str__()[:-1]}.{'.'.join(self.names)}}}"


@dataclass
class Scope:
    """The values of one instance of a tree: what each name is bound to.

    `around` is the tree that a strategy recovers: what a leaf takes from the tree by itself, such as the
    segment under way, it finds there if the strategy's own tree has none.
    """

    store: Store
    path: str
    types: Mapping[str, ValueType[Any]]
    bound: dict[str, Binding] = field(default_factory=dict)
    around: Scope | None = None

    def binding(self, name: str) -> Binding:
        """The place of a value; one that nobody passed in is the instance's own."""
        if name not in self.bound:
            self.bound[name] = self.store.slot(f"{self.path}:{name}")
        return self.bound[name]

    def preset(self, port: PortSpec) -> None:
        """Give a port that nobody passed in its declared default."""
        if isinstance(port.default, FromTree):
            self.bound[port.name] = Constant(None)
        elif port.direction is Direction.IN:
            self.bound[port.name] = Constant(port.default)
        elif port.default not in (None, REQUIRED):
            self.binding(port.name).write(port.default)

    def of(self, value: PortValue) -> Binding:
        if isinstance(value, Literal):
            return Constant(value.value)
        binding = self.binding(value.name)
        return _through(binding, self.types[value.name], value.attributes) if value.attributes else binding

    def default(self, port: PortSpec) -> Binding:
        """The binding of a port that the file does not mention."""
        if isinstance(port.default, FromTree):
            return self.typed(port.default.name, port.type)
        return Constant(None if port.default is REQUIRED else port.default)

    def typed(self, name: str, kind: ValueType[Any]) -> Binding:
        """The place of the value of this name and type, here or around; else a constant None."""
        known = self.types.get(name)
        if known is not None and known.name == kind.name:
            return self.binding(name)
        return Constant(None) if self.around is None else self.around.typed(name, kind)

    def read(self, name: str, attributes: tuple[str, ...]) -> Any:
        return read_attribute(self.types[name], self.binding(name).read(), attributes)


def _through(binding: Binding, kind: ValueType[Any], names: tuple[str, ...]) -> Binding:
    if isinstance(binding, Attribute):
        return Attribute(binding.store, binding.key, binding.kind, binding.names + names)
    if isinstance(binding, Slot):
        return Attribute(binding.store, binding.key, kind, names)
    return Constant(read_attribute(kind, binding.read(), names))
