"""A BehaviorTree.CPP file → tree files, checked as our own are, every complaint at its place in the XML."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.cli.importing.markup import Tag, read_markup
from executive.cli.importing.nodes import Draft, Translator
from executive.cli.importing.ports import (
    completed,
    declared,
    uses,
    walk,
)
from executive.config.source import Mark, Place, Source
from executive.core.errors import ConfigError, Problem
from executive.tree.catalogue import node_types
from executive.tree.load import check_trees

Ports = dict[str, dict[str, Any]]
"""By name, the ports of a tree as its file declares them."""


@dataclass(frozen=True)
class Imported:
    """Tree files as data, by name; `notes` say what means something a little different here."""

    trees: Mapping[str, Mapping[str, Any]]
    notes: tuple[Problem, ...]


def import_file(path: Path) -> Imported:
    """Read and translate a file; ConfigError with every problem in it. Nothing is written."""
    root = read_markup(path)
    return _Importer(root).imported()


class _Importer:
    """One file under translation."""

    def __init__(self, root: Tag) -> None:
        self.root, self.types = root, node_types()
        self.draft = Draft()
        self.tags: dict[str, Tag] = {}
        self.models = {
            name_of(model.attributes.get("ID", "")): model
            for models in root.named("TreeNodesModel")
            for model in models.named("SubTree")
        }

    def imported(self) -> Imported:
        self._look_over()
        roots: dict[str, Any] = {}
        drafts: dict[str, Draft] = {}
        for name, tag in self.tags.items():
            draft = drafts[name] = Draft()
            translator = Translator(self.types, name_of, draft)
            roots[name] = translator.node(tag.children[0], ("root",))
            self.draft.problems += draft.problems
            self.draft.notes += draft.notes
        ports = self._ports(roots, drafts)
        trees = {name: self._file(name, roots[name], ports[name]) for name in roots}
        sources = {name: self._source(name, trees[name], drafts[name]) for name in trees}
        strange = {kind for draft in drafts.values() for kind in draft.unknown}
        self.draft.problems += check_trees(sources, _using(roots, strange))
        if self.draft.problems:
            raise ConfigError(self.draft.problems)
        return Imported(trees, tuple(sorted(set(self.draft.notes))))

    def _look_over(self) -> None:
        """What the file as a whole must be, and its trees by name."""
        root, problem = self.root, self.draft.problems.append
        if root.name != "root":
            problem(root.mark.problem(f"got <{root.name}>, expected <root> of BehaviorTree.CPP"))
        elif root.attributes.get("BTCPP_format") != "4":
            got = root.attributes.get("BTCPP_format", "none")
            problem(root.at("BTCPP_format").problem(f'got the BTCPP_format "{got}", expected 4'))
        for tag in root.named("include"):
            problem(tag.mark.problem("got an include, expected one file; import the included file as well"))
        for tag in root.named("BehaviorTree"):
            self._look_at(tag)
        if not self.tags and not self.draft.problems:
            problem(root.mark.problem("got no tree, expected a <BehaviorTree>"))

    def _look_at(self, tag: Tag) -> None:
        problem = self.draft.problems.append
        given = tag.attributes.get("ID")
        name = name_of(given or "")
        if given is None:
            problem(tag.mark.problem("got a BehaviorTree without ID, expected a name"))
        elif name in self.tags:
            problem(tag.at("ID").problem(f'got the tree "{given}" a second time, expected it once'))
        elif len(tag.children) != 1:
            problem(tag.mark.problem(f"got {len(tag.children)} root nodes of {given}, expected one"))
        else:
            self.tags[name] = tag
            if name != given:
                self.draft.notes.append(tag.at("ID").problem(f'the tree "{given}" is called {name} here'))

    def _ports(self, roots: Mapping[str, Any], drafts: Mapping[str, Draft]) -> dict[str, Ports]:
        """The ports of every tree. Those of a tree rest on those of the trees in it: repeat until settled."""
        ports: dict[str, Ports] = {name: declared(self.models.get(name)) for name in roots}
        untold: dict[str, list[str]] = {}
        for _ in range(len(roots) + 1):
            for kind, content in (pair for draft in drafts.values() for pair in draft.remapped):
                for port in ports.get(kind, {}):
                    content.setdefault(port, f"{{{port}}}")
            before, ports = ports, {}
            given = _given(roots)
            for name, node in roots.items():
                found = uses(node, self.types, before)
                ports[name], untold[name] = completed(declared(self.models.get(name)), found, given[name])
            if ports == before:
                break
        for name, names in untold.items():
            words = (f"nothing tells the type of {{{value}}}: text is assumed" for value in names)
            self.draft.notes += [self.tags[name].mark.problem(word) for word in words]
        return ports

    def _file(self, name: str, root: Any, ports: Mapping[str, Any]) -> dict[str, Any]:
        doc = self.tags[name].attributes.get("_description", "")
        return {
            "tree": name,
            **({"doc": doc} if doc else {}),
            **({"ports": dict(ports)} if ports else {}),
            "root": root,
        }

    def _source(self, name: str, data: Mapping[str, Any], draft: Draft) -> Source:
        tag = self.tags[name]
        marks: dict[Place, Mark] = {(): tag.mark, ("tree",): tag.at("ID"), **draft.values}
        model = self.models.get(name)
        for port in model.children if model is not None else []:
            marks["ports", port.attributes.get("name", "")] = port.mark
        return Source(data, marks, folders={(): Path()})


def name_of(given: str) -> str:
    """A tree's ID as a name that our files take."""
    name = re.sub(r"\W+", "_", given, flags=re.ASCII).strip("_") or "unnamed"
    return name if not name[0].isdigit() else f"tree_{name}"


def _given(roots: Mapping[str, Any]) -> dict[str, set[str]]:
    """By tree, the ports that the trees using it give to it."""
    given: dict[str, set[str]] = {name: set() for name in roots}
    for node in roots.values():
        for kind, content, _ in walk(node):
            if kind in given:
                given[kind] |= set(content)
    return given


def _using(roots: Mapping[str, Any], strange: set[str]) -> set[str]:
    """The trees that hold a leaf nobody here knows, directly or in a sub-tree: they cannot be checked yet."""
    kinds = {name: {kind for kind, _, _ in walk(node)} for name, node in roots.items()}
    found = {name for name, used in kinds.items() if used & strange}
    while more := {name for name, used in kinds.items() if used & found} - found:
        found |= more
    return found
