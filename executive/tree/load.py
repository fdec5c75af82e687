"""A tree file → a `TreeSpec`, with everything in it and in its sub-trees checked."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

from executive.config.find import find, names, shown
from executive.config.registered import not_loaded
from executive.config.source import Mark, Source, read, read_text
from executive.config.validate import Problems, guess, parse
from executive.core.errors import ConfigError, Problem
from executive.tree.catalogue import broken_nodes, node_types
from executive.tree.file import TreeFile, declared_ports
from executive.tree.node_type import NodeType
from executive.tree.nodes.kind import LEAF_KIND
from executive.tree.order import TreeOrder
from executive.tree.order_of_nodes import order_of
from executive.tree.reader import TreeReader
from executive.tree.spec import NodeSpec, TreeSpec

MAX_SIZE = 5000
Instead = Mapping[Path, str]
"""Texts that stand for tree files: what if a file said something else?"""
AS_IT_IS: Instead = {}


def load_tree(
    reference: Path | str, types: Mapping[str, NodeType] | None = None, instead: Instead = AS_IT_IS
) -> TreeSpec:
    """Load by path or bare name; ConfigError with every problem in the file and the trees it uses.

    `types` are the node types to use in place of those registered. A file among `instead` (by its absolute
    path) is taken to hold the text given there.
    """
    if isinstance(reference, str):
        reference = find("trees", reference, Path.cwd(), Mark(reference, 1, 1))
    given = {str(path): _in_place_of(path, text) for path, text in instead.items()}
    return _Trees(types or node_types(), given).load(reference.absolute(), ())


def tree_in(source: Source) -> TreeSpec:
    """The same from a file already read."""
    path = Path(source.at(()).file).absolute()
    return _Trees(node_types(), {str(path): source}).load(path, ())


def load_tree_text(text: str, name: str = "tree", types: Mapping[str, NodeType] | None = None) -> TreeSpec:
    """The same from text; other trees are found by bare name or from the working folder."""
    return _Trees(types or node_types()).read(read_text(text, name), ())


def check_trees(sources: Mapping[str, Source], skipped: Container[str] = ()) -> list[Problem]:
    """Every problem of trees given by name, as if they were files that can use each other."""
    trees, problems = _Trees(node_types(), sources), Problems()
    for name in sources:
        if name not in skipped:
            problems.attempt(trees.load, Path(name), ())
    return sorted(set(problems.found))


def _in_place_of(path: Path, text: str) -> Source:
    return replace(read_text(text, shown(path)), folders={(): path.parent})


class _Trees:
    """One loading: every file is read once, however often it is used. `given` trees need no file."""

    def __init__(self, types: Mapping[str, NodeType], given: Mapping[str, Source] | None = None) -> None:
        self.types, self.given = types, given or {}
        self.loaded: dict[Path, TreeSpec | ConfigError] = {}

    def load(self, path: Path, stack: tuple[Path, ...]) -> TreeSpec:
        if path not in self.loaded:
            try:
                source = self.given.get(str(path)) or read(path, shown(path))
                self.loaded[path] = self.read(source, (*stack, path))
            except ConfigError as error:
                self.loaded[path] = error
        result = self.loaded[path]
        if isinstance(result, ConfigError):
            raise result
        return result

    def read(self, source: Source, stack: tuple[Path, ...]) -> TreeSpec:
        problems = Problems(source)
        file = problems.attempt(parse, source, TreeFile)
        ports = problems.attempt(declared_ports, source)
        reader = TreeReader(source, self.types, ports or (), problems, partial(self._tree, source, stack))
        has_root = isinstance(source.data, dict) and source.data.get("root") is not None
        root = reader.node(("root",)) if has_root else None
        if file is not None and ports is not None:
            problems.found.extend(reader.flow.problems())
        order = TreeOrder()
        if root is not None and not problems.found:
            order, early = order_of(root, ports or ())
            problems.found.extend(early)
        problems.check()
        if file is None or root is None:
            raise ConfigError([source.key_at(("root",)).problem("got no root, expected a node")])
        size = _size(root)
        if size > MAX_SIZE:
            message = f"got a tree of {size} nodes with its sub-trees, expected {MAX_SIZE} at most"
            raise ConfigError([source.at(()).problem(message)])
        values, shown_file = reader.flow.types, source.at(()).file
        return TreeSpec(file.tree, file.doc, shown_file, ports or (), root, values, size, order)

    def _tree(self, source: Source, stack: tuple[Path, ...], word: str, mark: Mark) -> TreeSpec:
        """The tree that a node of `source` uses, inside those of `stack`."""
        try:
            path = Path(word) if word in self.given else find("trees", word, source.folder(), mark)
        except ConfigError:
            raise ConfigError([mark.problem(self._unknown(word, source))]) from None
        if path in stack:
            chain = " > ".join(p.stem for p in (*stack[stack.index(path) :], path))
            message = f"got a tree inside itself ({chain}), expected no recursion"
            raise ConfigError([mark.problem(message)])
        return self.load(path, stack)

    def _unknown(self, word: str, source: Source) -> str:
        """Why there is no such node: it is broken, misspelt, or in a plug-in that is not loaded."""
        broken = next((each for each in broken_nodes() if each.name == word), None)
        if broken is not None:
            return str(broken)
        near = guess(word, [*self.types, *names("trees", folder=source.folder())])
        return f'got the unknown node "{word}", expected a node or a tree{near}{not_loaded(LEAF_KIND)}'


def _size(node: NodeSpec) -> int:
    return 1 + (node.tree.size if node.tree else 0) + sum(_size(child) for child in node.children)
