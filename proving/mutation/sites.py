"""The nodes of a tree file as places in its data, where an operator can change them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from executive.config.source import Mark, Place, Source
from executive.tree.node_type import NodeType
from executive.tree.nodes.control import Children
from executive.tree.spec import BESIDE


@dataclass(frozen=True)
class Site:
    """One node of a file: where it stands, what type it is of, where its children stand.

    `place` is the whole node, guards and all, `inside` what is given to it. `listing` is the list that its
    children stand in, None where it has none or only one.
    """

    place: Place
    word: str
    mark: Mark
    data: Any
    inside: Place
    children: tuple[Place, ...] = ()
    listing: Place | None = None

    @property
    def guards(self) -> dict[str, str]:
        """What stands beside the node, its name apart."""
        beside = self.data if isinstance(self.data, dict) else {}
        return {key: beside[key] for key in BESIDE if key in beside and key != "name"}


def sites(source: Source, types: Mapping[str, NodeType]) -> Iterator[Site]:
    """Every node of a checked tree file, parents first; trees used as nodes are one each."""
    waiting: list[Place] = [("root",)]
    while waiting:
        site = _site(source, waiting.pop(), types)
        yield site
        waiting.extend(reversed(site.children))


def _site(source: Source, place: Place, types: Mapping[str, NodeType]) -> Site:
    data = source.get(place)
    if isinstance(data, str):
        return Site(place, data, source.key_at(place), data, place)
    (word,) = (key for key in data if key not in BESIDE)
    inside = (*place, word)
    children, listing = _children(source, inside, types.get(word))
    return Site(place, word, source.key_at(inside), data, inside, children, listing)


def _children(source: Source, inside: Place, kind: NodeType | None) -> tuple[tuple[Place, ...], Place | None]:
    given = source.get(inside)
    if kind is None or kind.children is Children.NONE:
        return (), None
    if kind.children is Children.ONE:
        return ((*inside, "child") if isinstance(given, dict) and "child" in given else inside,), None
    listing = (*inside, "children") if isinstance(given, dict) else inside
    return tuple((*listing, index) for index in range(len(source.get(listing)))), listing
