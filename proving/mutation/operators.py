"""What may be changed in a tree: one operator a kind of mistake that people make."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from executive.config.source import Place, Source
from executive.core import registry
from executive.core.units import UnitError, split
from executive.core.values import VALUE_TYPE_KIND
from executive.tree.catalogue import inverter
from executive.tree.node_type import NodeType
from executive.tree.nodes.control import Children
from executive.tree.ports import PortSpec
from executive.tree.spec import BESIDE
from proving.mutation.sites import Site

ABSENT = object()
"""In place of a value: the key goes."""
LARGER, SMALLER = 4.0, 0.25
_COMPARISON = re.compile(r"(?<![<>=!])([<>]=?)(?!=)\s*")
_NEGLIGENT = {"<": "2 * ", "<=": "2 * ", ">": "0.5 * ", ">=": "0.5 * "}


@dataclass(frozen=True)
class Change:
    """One change of a file's data: what stands at `place` afterwards, in words `what`."""

    place: Place
    value: Any
    what: str


@dataclass(frozen=True)
class MutationSite:
    """What an operator sees: the file, the ports of a type of node, its kind where it is no tree."""

    source: Source
    types: Mapping[str, NodeType]
    ports: Callable[[str], Mapping[str, PortSpec]]

    def label(self, place: Place) -> str:
        """How a node is called."""
        data = self.source.get(place)
        if isinstance(data, str):
            return data
        return str(data.get("name") or next(key for key in data if key not in BESIDE))


Operator = Callable[[MutationSite, Site], Iterator[Change]]


def swap_children(scene: MutationSite, site: Site) -> Iterator[Change]:
    """Two neighbours change places."""
    children = scene.source.get(site.listing) if site.listing else []
    for i in range(len(children) - 1):
        swapped = [*children[:i], children[i + 1], children[i], *children[i + 2 :]]
        if site.listing and children[i] != children[i + 1]:
            first, second = (scene.label((*site.listing, n)) for n in (i, i + 1))
            yield Change(site.listing, swapped, f"swap {first} and {second} ({i + 1}, {i + 2})")


def drop_child(scene: MutationSite, site: Site) -> Iterator[Change]:
    """A child is missing."""
    children = scene.source.get(site.listing) if site.listing else []
    kind = scene.types.get(site.word)
    if site.listing and len(children) > 1 and kind is not None and kind.children is Children.MANY:
        for i in range(len(children)):
            label = scene.label((*site.listing, i))
            yield Change(site.listing, children[:i] + children[i + 1 :], f"drop {label} ({i + 1})")


def invert(scene: MutationSite, site: Site) -> Iterator[Change]:
    """Success for failure, or a sequence for a selector."""
    kind = scene.types.get(site.word)
    other = kind.control.counterpart if kind is not None and kind.control is not None else None
    if other is not None:
        renamed = {other if key == site.word else key: value for key, value in site.data.items()}
        yield Change(site.place, renamed, f"{other} for {site.word}")
    elif not site.children:
        yield Change(site.place, {inverter().name: {"child": site.data}}, f"invert {scene.label(site.place)}")


def unwrap(scene: MutationSite, site: Site) -> Iterator[Change]:
    """A decorator is missing; `recover` is the one that matters most."""
    kind = scene.types.get(site.word)
    if kind is None or kind.children is not Children.ONE or kind.names_an_item:
        return  # what it is, or what its child speaks of, would be gone too
    child = scene.source.get(site.children[0])
    bare = {child: None} if isinstance(child, str) else child
    if not site.guards.keys() & bare.keys():
        yield Change(site.place, bare | site.guards, f"drop {site.word}, keep its child")


def weaken_guard(scene: MutationSite, site: Site) -> Iterator[Change]:
    """A guard is missing, says the opposite, or is too generous."""
    for word, text in site.guards.items():
        place = (*site.place, word)
        yield Change(place, ABSENT, f"drop {word}")
        yield Change(place, f"not ({text})", f"negate {word}")
        generous = _COMPARISON.sub(lambda m: f"{m[1]} {_NEGLIGENT[m[1]]}", text)
        if generous != text:
            yield Change(place, generous, f"be twice as generous in {word}")


def change_literal(scene: MutationSite, site: Site) -> Iterator[Change]:
    """A number is four times too large or too small, a switch or a word the other one."""
    given = scene.source.get(site.inside)
    if not isinstance(given, dict):
        return
    for name, port in scene.ports(site.word).items():
        if name in given:
            for value in _others(given[name], port):
                yield Change((*site.inside, name), value, f"{name} {value} for {given[name]}")


OPERATORS: dict[str, Operator] = {
    operator.__name__: operator
    for operator in (swap_children, drop_child, invert, unwrap, weaken_guard, change_literal)
}


def defaults(source: Source) -> Iterator[Change]:
    """The defaults in a tree's own ports, as `change_literal` changes what is given to a node."""
    for name, port in (source.data.get("ports") or {}).items():
        kind = registry.get(VALUE_TYPE_KIND, port["type"])
        if kind.literal and "default" in port:
            for value in _scaled(port["default"]):
                yield Change(("ports", name, "default"), value, f"{name} {value} for {port['default']}")


def _others(given: Any, port: PortSpec) -> Iterator[Any]:
    if isinstance(given, str) and given.startswith("{"):
        return
    choices = port.choices
    if issubclass(port.type.python, Enum):
        choices = tuple(str(member.value) for member in port.type.python)
    if choices:
        yield from (word for word in choices if word != given)
    else:
        yield from _scaled(given)


def _scaled(given: Any) -> Iterator[Any]:
    """A number with or without unit, larger and smaller; nothing for zero, text and references."""
    if isinstance(given, bool):
        yield not given
    elif isinstance(given, int):
        yield from (n for n in (given * int(LARGER), max(1, int(given * SMALLER))) if n != given)
    elif isinstance(given, float) and given:
        yield from (given * LARGER, given * SMALLER)
    elif isinstance(given, str):
        try:
            value, unit = split(given)
        except UnitError:
            return
        if value:
            yield from (f"{value * factor:g} {unit}".rstrip() for factor in (LARGER, SMALLER))
