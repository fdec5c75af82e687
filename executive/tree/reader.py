"""The nodes of one tree file, read one by one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from executive.config.source import Mark, Place, Source
from executive.config.validate import Problems, guess, listed, shown
from executive.core.errors import ConfigError
from executive.tree.catalogue import former_names
from executive.tree.expressions.guards import Guard, parse_guard
from executive.tree.expressions.typed import GuardError
from executive.tree.flow import Flow
from executive.tree.given import given_children, given_parameters, given_ports
from executive.tree.node_type import NodeType
from executive.tree.ports import PortSpec
from executive.tree.spec import BESIDE, GUARDS, NodeSpec, TreeSpec

FindTree = Callable[[str, Mark], TreeSpec]
"""The tree of a name, for a node at a mark; ConfigError where there is none."""


class TreeReader:
    """Reads the nodes of one file; `flow` collects what they do with the tree's values."""

    def __init__(
        self,
        source: Source,
        types: Mapping[str, NodeType],
        ports: tuple[PortSpec, ...],
        problems: Problems,
        find_tree: FindTree,
    ) -> None:
        self.source, self.types, self.problems, self.find_tree = source, types, problems, find_tree
        self.flow = Flow(ports)

    def node(self, place: Place) -> NodeSpec | None:
        """The node at `place`, or None after noting what is wrong with it."""
        return self.problems.attempt(self._node, place)

    def _node(self, place: Place) -> NodeSpec:
        data = self.source.get(place)
        if isinstance(data, str):
            return self._typed(place, data, place, {})
        if not isinstance(data, dict):
            message = f"got {shown(data)}, expected a node such as {{wait: {{duration: 5 s}}}}"
            raise ConfigError([self.source.at(place).problem(message)])
        kinds = [key for key in data if key not in BESIDE]
        if len(kinds) != 1:
            got = listed(kinds) if kinds else "no node type"
            message = f"got {got}, expected exactly one node type beside {listed(BESIDE)}"
            extra = self._beside_guess(kinds)
            raise ConfigError([self.source.at(place).problem(message + extra)])
        return self._typed((*place, kinds[0]), kinds[0], place, data)

    def _beside_guess(self, kinds: list[str]) -> str:
        unknown = [kind for kind in kinds if kind not in self.types]
        return next((text for kind in unknown if (text := guess(kind, BESIDE))), "")

    def _typed(self, place: Place, word: str, outer: Place, beside: Mapping[str, Any]) -> NodeSpec:
        """The node of type `word` whose parameters stand at `place`."""
        local = Problems()
        guards = {
            key: guard for key in GUARDS if key in beside if (guard := self._guard((*outer, key), local))
        }
        mark, tree = self.source.key_at(place), None
        kind = self.types.get(word) or self.types.get(former_names().get(word, ""))
        name = self._name(outer, kind.name if kind else word, beside, local)
        given = local.attempt(given_parameters, self.source, place, word, kind)
        if kind is None:
            tree = local.attempt(self.find_tree, word, mark)
            kind = NodeType(word, "tree", tree.doc, tree.ports) if tree else None
        if kind is None or given is None:
            local.check()
            raise ConfigError([mark.problem("cannot be read")])
        ports = given_ports(self.source, place, kind, given, self.flow, local)
        children = given_children(self.source, place, kind, given, self.node, local)
        local.check()
        marks = {key: self.source.at((*place, key)) for key in ports if key in given}
        marks |= {key: self.source.at((*outer, key)) for key in guards}
        return NodeSpec(kind, name, mark, ports, guards, children, tree, marks)

    def _guard(self, place: Place, local: Problems) -> Guard | None:
        text, mark = self.source.get(place), self.source.at(place)
        if isinstance(text, bool):
            text = str(text).lower()
        if not isinstance(text, str):
            local.add(mark.problem(f"got {shown(text)}, expected an expression such as {{x}} < 30 mm"))
            return None
        try:
            guard = parse_guard(text)
        except GuardError as error:
            local.add(mark.problem(error.message, error.offset))
            return None
        self.flow.guard(guard, mark)
        return guard

    def _name(self, outer: Place, word: str, beside: Mapping[str, Any], local: Problems) -> str:
        name = beside.get("name", Path(word).stem)
        if isinstance(name, str) and name and not set(name) & set("/#\n"):
            return name
        message = f"got {shown(name)}, expected a name without / and #"
        local.add(self.source.at((*outer, "name")).problem(message))
        return word
