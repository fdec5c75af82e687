"""What Groot2 and BehaviorTree.CPP v4 call a node, declared by the node and used by export and import."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

Write = Callable[[object], str | None]
"""A literal in SI as their attribute has it; None: as the tree file says it."""

Read = Callable[[str, int], object]
"""Text of an attribute, and the number of children → what a tree file would say; None: nothing.

ValueError with a message for a text that cannot be said in a tree file.
"""


def as_it_is(value: object) -> str | None:
    """Written as the tree file says it."""
    return None


def as_given(text: str, children: int) -> object:
    """Read as text of the port's type."""
    return text


@dataclass(frozen=True)
class Attribute:
    """The attribute that stands for a port, and how its values are written and read there."""

    name: str
    write: Write = as_it_is
    read: Read = as_given


@dataclass(frozen=True)
class Variant:
    """Another element that is the same node with these ports set.

    `written`: a node with these values is exported as it. `note` says on import what to know about it.
    """

    ports: Mapping[str, object] = field(default_factory=dict)
    written: bool = False
    note: str = ""


@dataclass(frozen=True)
class Groot:
    """The element for a node: its tag, what its attributes are called, which other tags mean it too.

    `constants` are attributes with the one value that we can say, and why no other.
    """

    tag: str
    attributes: Mapping[str, Attribute] = field(default_factory=dict)
    variants: Mapping[str, Variant] = field(default_factory=dict)
    constants: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def written_as(self, ports: Mapping[str, object]) -> str:
        """The tag for a node with these literals."""
        for tag, variant in self.variants.items():
            if variant.written and all(ports.get(name) == value for name, value in variant.ports.items()):
                return tag
        return self.tag

    @property
    def told_by_tag(self) -> frozenset[str]:
        """The ports whose values the choice of tag says."""
        written = (variant.ports for variant in self.variants.values() if variant.written)
        return frozenset(name for ports in written for name in ports)
