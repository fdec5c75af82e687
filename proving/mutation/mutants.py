"""The mutants of a tree, of the trees that it uses and of its strategies, each a text in place of a file."""

from __future__ import annotations

import copy
import difflib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from executive.config.find import shown
from executive.config.source import Mark, Source, read
from executive.config.validate import guess, listed
from executive.core.errors import ConfigError, Problem
from executive.pool import Strategy
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree
from executive.tree.node_type import NodeType
from executive.tree.ports import PortSpec
from executive.tree.spec import NodeSpec, TreeSpec, walk
from executive.tree.strategies import strategy_trees
from proving.coverage.universe import Universe
from proving.mutation.operators import ABSENT, OPERATORS, Change, MutationSite, defaults
from proving.mutation.sites import sites


@dataclass(frozen=True)
class Mutant:
    """A tree file changed in one place. `node` is where, as coverage calls it."""

    file: Path
    node: str
    operator: str
    what: str
    before: str
    after: str

    @property
    def name(self) -> str:
        return f"{self.node}: {self.what}"

    @property
    def instead(self) -> dict[str, str]:
        """The text that stands for the file, as a case has it."""
        return {str(self.file): self.after}

    def diff(self) -> str:
        """The change as a unified diff of the file's data."""
        lines = difflib.unified_diff(
            self.before.splitlines(), self.after.splitlines(), self.file.name, self.what, n=2, lineterm=""
        )
        return "\n".join(lines)


@dataclass(frozen=True)
class Forest:
    """A mission's tree with all that may run in it: the files by path, and the names of their nodes."""

    universe: Universe
    files: dict[Path, TreeSpec]

    @classmethod
    def of(cls, tree: Path | str, strategies: tuple[Strategy, ...]) -> Forest:
        """ConfigError with every problem of the tree and of those it uses."""
        main, answers = load_tree(tree), strategy_trees(strategies)
        universe = Universe()
        universe.add(main, answers)
        files = {Path(spec.file).absolute(): spec for spec in universe.trees.values()}
        return cls(universe, files)

    def mutants(self, only: Collection[str] = ()) -> Iterator[Mutant]:
        """Every mutant that differs from the original and can be loaded, file by file.

        `only` are the names of the trees to change (none: all); ConfigError for one that is not there.
        """
        known = [spec.name for spec in self.files.values()]
        strangers = [name for name in only if name not in known]
        if strangers:
            raise ConfigError([_stranger(name, known) for name in strangers])
        for path, spec in self.files.items():
            if only and spec.name not in only:
                continue
            seen: set[str] = set()
            for mutant in _mutants(path, spec):
                if mutant.after not in seen and mutant.after != mutant.before and _loads(mutant):
                    seen.add(mutant.after)
                    yield mutant


def _stranger(name: str, known: list[str]) -> Problem:
    return Problem("--only", 1, 1, f'got "{name}", expected {listed(known)}{guess(name, known)}')


def _loads(mutant: Mutant) -> bool:
    """Whether the changed file passes the checks of a tree; who uses it sees the same ports as before."""
    try:
        load_tree(mutant.file, instead={mutant.file: mutant.after})
    except ConfigError:
        return False
    return True


def _mutants(path: Path, spec: TreeSpec) -> Iterator[Mutant]:
    source, types = read(path, shown(path)), node_types()
    names = _names(spec)
    before = dumped(source.data)
    scene = MutationSite(source, types, lambda word: _ports(word, types, spec))

    def mutant(node: str, operator: str, change: Change) -> Mutant:
        return Mutant(path, node, operator, change.what, before, dumped(changed(source, change)))

    for site in sites(source, types):
        for name, operator in OPERATORS.items():
            for change in operator(scene, site):
                yield mutant(names[site.mark], name, change)
    for change in defaults(source):
        yield mutant(f"{spec.name}/{spec.root.name}", "change_literal", change)


def _names(spec: TreeSpec) -> dict[Mark, str]:
    """What coverage calls the node that stands at a mark of this file."""
    found: dict[Mark, str] = {}
    for path, node in walk(spec):
        if node.mark.file == spec.file:
            found.setdefault(node.mark, path)
    return found


def _ports(word: str, types: Mapping[str, NodeType], spec: TreeSpec) -> dict[str, PortSpec]:
    if word in types:
        return {port.name: port for port in types[word].ports}
    used = next((node.tree for node in _nodes(spec.root) if node.type == word and node.tree), None)
    return {port.name: port for port in used.ports} if used else {}


def _nodes(node: NodeSpec) -> Iterator[NodeSpec]:
    yield node
    for child in node.children:
        yield from _nodes(child)


def changed(source: Source, change: Change) -> Any:
    """The file's data with the change in it."""
    data = copy.deepcopy(source.data)
    *outer, last = change.place
    around = data
    for step in outer:
        around = around[step]
    if change.value is ABSENT:
        del around[last]
    else:
        around[last] = change.value
    return data


class _Dumper(yaml.SafeDumper):
    """What a node is given stands on its line, as people write trees."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def dumped(data: Any) -> str:
    """A tree file's data as YAML."""
    return yaml.dump(
        data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=200, default_flow_style=None
    )
