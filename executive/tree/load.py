"""A tree file → a `TreeSpec`, with everything in it and in its sub-trees checked."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from executive.config.find import find, names, shown
from executive.config.registered import not_loaded
from executive.config.source import Mark, Place, Source, read, read_text
from executive.config.validate import Problems, guess, listed, parse
from executive.config.validate import shown as shown_data
from executive.core import registry
from executive.core.errors import ConfigError, Problem
from executive.tree.catalogue import ITEMS, NodeType, node_types
from executive.tree.expressions.guards import parse_guard
from executive.tree.expressions.typed import GuardError
from executive.tree.file import TreeFile, declared_ports
from executive.tree.flow import Flow
from executive.tree.literals import port_value
from executive.tree.nodes.base import (
    REQUIRED,
    Direction,
    PortSpec,
)
from executive.tree.nodes.kind import LEAF_KIND, Leaves
from executive.tree.spec import GUARDS, Literal, NodeSpec, PortValue, Reference, TreeSpec

MAX_SIZE = 5000
Instead = Mapping[Path, str]
"""Texts that stand for tree files: what if a file said something else?"""
AS_IT_IS: Instead = {}
BESIDE = ("name", *GUARDS)
CHILD_KEYS = {"none": (), "one": ("child",), "two": ("children",), "many": ("children",)}


def load_tree(reference: Path | str, leaves: Leaves | None = None, instead: Instead = AS_IT_IS) -> TreeSpec:
    """Load by path or bare name; ConfigError with every problem in the file and the trees it uses.

    A file among `instead` (by its absolute path) is taken to hold the text given there.
    """
    if isinstance(reference, str):
        reference = find("trees", reference, Path.cwd(), Mark(reference, 1, 1))
    given = {str(path): _in_place_of(path, text) for path, text in instead.items()}
    return _Trees(node_types(leaves), given).load(reference.absolute(), ())


def load_tree_text(text: str, name: str = "tree", leaves: Leaves | None = None) -> TreeSpec:
    """The same from text; other trees are found by bare name or from the working folder."""
    return _Trees(node_types(leaves)).read(read_text(text, name), ())


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
        problems = Problems()
        file = problems.attempt(parse, source, TreeFile)
        ports = problems.attempt(declared_ports, source, file) if file else ()
        reader = _TreeReader(self, source, stack, ports or (), problems)
        has_root = isinstance(source.data, dict) and source.data.get("root") is not None
        root = reader.node(("root",)) if has_root else None
        if file is not None and ports is not None:
            problems.found.extend(reader.flow.problems())
        problems.check()
        if file is None or root is None:
            raise ConfigError([source.key_at(("root",)).problem("got no root, expected a node")])
        size = _size(root)
        if size > MAX_SIZE:
            message = f"got a tree of {size} nodes with its sub-trees, expected {MAX_SIZE} at most"
            raise ConfigError([source.at(()).problem(message)])
        return TreeSpec(file.tree, file.doc, source.at(()).file, ports or (), root, reader.flow.types, size)


def _size(node: NodeSpec) -> int:
    return 1 + (node.tree.size if node.tree else 0) + sum(_size(child) for child in node.children)


class _TreeReader:
    """Reads the nodes of one file."""

    def __init__(
        self,
        trees: _Trees,
        source: Source,
        stack: tuple[Path, ...],
        ports: tuple[PortSpec, ...],
        problems: Problems,
    ) -> None:
        self.trees, self.source, self.stack, self.problems = trees, source, stack, problems
        self.flow = Flow(ports)

    def node(self, place: Place) -> NodeSpec | None:
        """The node at `place`, or None after noting what is wrong with it."""
        return self.problems.attempt(self._node, place)

    def _node(self, place: Place) -> NodeSpec:
        data = self.source.get(place)
        if isinstance(data, str):
            return self._typed(place, data, place, {})
        if not isinstance(data, dict):
            message = f"got {shown_data(data)}, expected a node such as {{wait: {{duration: 5 s}}}}"
            raise ConfigError([self.source.at(place).problem(message)])
        kinds = [key for key in data if key not in BESIDE]
        if len(kinds) != 1:
            got = listed(kinds) if kinds else "no node type"
            message = f"got {got}, expected exactly one node type beside {listed(BESIDE)}"
            extra = self._beside_guess(kinds)
            raise ConfigError([self.source.at(place).problem(message + extra)])
        return self._typed((*place, kinds[0]), kinds[0], place, data)

    def _beside_guess(self, kinds: list[str]) -> str:
        unknown = [kind for kind in kinds if kind not in self.trees.types]
        return next((text for kind in unknown if (text := guess(kind, BESIDE))), "")

    def _typed(self, place: Place, word: str, outer: Place, beside: Mapping[str, Any]) -> NodeSpec:
        """The node of type `word` whose parameters stand at `place`."""
        local = Problems()
        guards = {
            key: guard for key in GUARDS if key in beside if (guard := self._guard((*outer, key), local))
        }
        name = self._name(outer, word, beside, local)
        mark = self.source.key_at(place)
        parameters = self._parameters(place, word, local)
        tree: TreeSpec | None = None
        kind = self.trees.types.get(word)
        if kind is None:
            tree = local.attempt(self._tree, word, mark)
            kind = NodeType(word, "tree", tree.doc, tree.ports) if tree else None
        ports: dict[str, PortValue] = {}
        children: list[NodeSpec] = []
        if kind is not None and parameters is not None:
            ports = self._ports(place, kind, parameters, local)
            children = self._children(place, kind, parameters, local)
        self._check_item(place, kind, ports, local)
        local.check()
        if kind is None:
            raise ConfigError([mark.problem("cannot be read")])
        item = str(ports["as"]) if kind.name == "for_each" else None
        return NodeSpec(word, kind.category, name, mark, ports, guards, tuple(children), tree, item)

    def _guard(self, place: Place, local: Problems) -> Any:
        text, mark = self.source.get(place), self.source.at(place)
        if isinstance(text, bool):
            text = str(text).lower()
        if not isinstance(text, str):
            local.add(mark.problem(f"got {shown_data(text)}, expected an expression such as {{x}} < 30 mm"))
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
        message = f"got {shown_data(name)}, expected a name without / and #"
        local.add(self.source.at((*outer, "name")).problem(message))
        return word

    def _parameters(self, place: Place, word: str, local: Problems) -> dict[str, Any] | None:
        """What is given to the node, a short form written out; None after noting what is wrong."""
        data = self.source.get(place)
        kind = self.trees.types.get(word)
        if data is None or (isinstance(data, str) and data == word):
            return {}
        if kind is not None and kind.children == "one" and not kind.ports and isinstance(data, str):
            return {data: None}  # a bare child: `inverter: facing`
        if kind is not None and kind.children in ("two", "many") and isinstance(data, list):
            return {"children": data}
        if isinstance(data, dict):
            return data
        local.add(self.source.at(place).problem(f"got {shown_data(data)}, expected the ports of {word}"))
        return None

    def _tree(self, word: str, mark: Mark) -> TreeSpec:
        try:
            given = word in self.trees.given
            path = Path(word) if given else find("trees", word, self.source.folder(), mark)
        except ConfigError:
            raise ConfigError([mark.problem(self._unknown(word))]) from None
        if path in self.stack:
            chain = " > ".join(p.stem for p in (*self.stack[self.stack.index(path) :], path))
            message = f"got a tree inside itself ({chain}), expected no recursion"
            raise ConfigError([mark.problem(message)])
        return self.trees.load(path, self.stack)

    def _unknown(self, word: str) -> str:
        """Why there is no such node: it is broken, misspelt, or in a plug-in that is not loaded."""
        broken = next((each for each in registry.broken(LEAF_KIND) if each.name == word), None)
        if broken is not None:
            return str(broken)
        near = guess(word, [*self.trees.types, *names("trees", folder=self.source.folder())])
        return f'got the unknown node "{word}", expected a node or a tree{near}{not_loaded(LEAF_KIND)}'

    def _ports(
        self, place: Place, kind: NodeType, given: Mapping[str, Any], local: Problems
    ) -> dict[str, PortValue]:
        known = {port.name: port for port in kind.ports}
        structural = CHILD_KEYS[kind.children]
        for key in given:
            if key not in known and key not in structural and not self._is_bare_child(kind, given):
                expected = listed([*known, *structural]) or "none"
                message = f'got the unknown port "{key}" of {kind.name}, expected {expected}'
                local.add(self.source.key_at((*place, key)).problem(message + guess(key, known)))
        values: dict[str, PortValue] = {}
        for name, port in known.items():
            if name in given:
                value = local.attempt(self._port, (*place, name), kind, port)
                if value is not None:
                    values[name] = value
            elif port.default is REQUIRED and (
                port.direction is not Direction.OUT or kind.category == "leaf"
            ):
                message = (
                    f'got no "{name}" for {kind.name}, expected {port.help or "a value"} ({port.type.name})'
                )
                local.add(self.source.key_at(place).problem(message))
            elif name in kind.fixed:
                values[name] = Literal(port.default)
        return values

    def _port(self, place: Place, kind: NodeType, port: PortSpec) -> PortValue:
        value = port_value(self.source, place, port, port.name in kind.fixed)
        mark = self.source.at(place)
        if isinstance(value, Reference):
            self.flow.use(value, port, mark)
            return value
        options = (kind.choices or {}).get(port.name)
        if options and value.value not in options:
            message = (
                f"got {shown_data(value.value)}, expected {listed(options)}{guess(value.value, options)}"
            )
            raise ConfigError([mark.problem(message)])
        counts = port.type.name == "integer" and port.name in kind.fixed
        if counts and isinstance(value.value, int) and value.value < 1:
            raise ConfigError([mark.problem(f"got {value.value}, expected 1 or more")])
        return value

    def _is_bare_child(self, kind: NodeType, given: Mapping[str, Any]) -> bool:
        """Whether a decorator without ports has its child right under it: `inverter: {facing: {...}}`."""
        return kind.children == "one" and not kind.ports and "child" not in given

    def _children(
        self, place: Place, kind: NodeType, given: Mapping[str, Any], local: Problems
    ) -> list[NodeSpec]:
        if kind.children == "none":
            return []
        if kind.children == "one":
            if "child" not in given and not (self._is_bare_child(kind, given) and given):
                message = f"got no child for {kind.name}, expected exactly one"
                local.add(self.source.key_at(place).problem(message))
                return []
            inner = place if "child" not in given else (*place, "child")
            return [child for child in (self.node(inner),) if child]
        listing = given.get("children")
        base = (*place, "children") if isinstance(self.source.get(place), dict) else place
        if not isinstance(listing, list) or not listing:
            message = f"got {shown_data(listing)} as children of {kind.name}, expected a list of nodes"
            local.add(self.source.at(base).problem(message))
            return []
        if kind.children == "two" and len(listing) != 2:
            message = f"got {len(listing)} children of {kind.name}, expected two: the question and the deed"
            local.add(self.source.at(base).problem(message))
        return [child for index in range(len(listing)) if (child := self.node((*base, index)))]

    def _check_item(
        self, place: Place, kind: NodeType | None, ports: Mapping[str, PortValue], local: Problems
    ) -> None:
        if kind is None or kind.name != "for_each" or "as" not in ports:
            return
        name = str(ports["as"])
        mark = self.source.at((*place, "as"))
        if not name.isidentifier():
            local.add(mark.problem(f"got {name!r}, expected a name"))
            return
        (list_port,) = (port for port in kind.ports if port.name == "in")
        local.found.extend(self.flow.item(name, ITEMS[list_port.type.name], mark))
