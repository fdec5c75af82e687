"""Where the values of a tree are kept, and what a port of a node is bound to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


class Store:
    """The values of one tree, keyed by scope and name. Two trees never share one; it can be pickled."""

    def __init__(self) -> None:
        self.values: dict[str, object] = {}

    def slot(self, key: str) -> Slot:
        return Slot(self, key)


@dataclass(frozen=True)
class Slot:
    """A named place in a store. Unset until written."""

    store: Store
    key: str

    def read(self) -> Any:
        return self.store.values.get(self.key)

    def write(self, value: object) -> None:
        self.store.values[self.key] = value

    def __str__(self) -> str:
        """As a file refers to it in the tree that it belongs to: `{pose}`."""
        return f"{{{self.key.rpartition(':')[2]}}}"


@dataclass(frozen=True)
class Constant:
    """A literal from the file."""

    value: object

    def read(self) -> Any:
        return self.value

    def write(self, value: object) -> None:
        raise TypeError("a literal cannot be written to")

    def __str__(self) -> str:
        return "its value" if self.value is None else str(self.value)


Binding = Slot | Constant
