"""YAML text → plain data with the place of every value and key. YAML 1.2 core schema, no tags."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml
from yaml.composer import Composer
from yaml.parser import Parser
from yaml.reader import Reader, ReaderError
from yaml.resolver import BaseResolver
from yaml.scanner import Scanner

from executive.core.errors import ConfigError, Problem

MAX_BYTES = 1_000_000
MAX_DEPTH = 64
MAX_NODES = 50_000

Place = tuple[str | int, ...]
"""Keys and indices from the root of a file to a value in it."""


@dataclass(frozen=True)
class Mark:
    """Where something stands; `inner` is the column offset of a scalar's own text (1 inside quotes)."""

    file: str
    line: int
    column: int
    inner: int = 0

    def problem(self, message: str, offset: int | None = None) -> Problem:
        """A complaint about this place, or about the `offset`-th character of the text standing here."""
        shift = 0 if offset is None else self.inner + offset
        return Problem(self.file, self.line, self.column + shift, message)


@dataclass(frozen=True)
class Source:
    """A file's data and places. `problems` are those after which reading could go on; `spoilt` are the values
    of which they speak, and of which no more need be said.

    `folders` says which folder relative references under a place start from (the longest prefix wins).
    """

    data: Any
    values: Mapping[Place, Mark]
    keys: Mapping[Place, Mark] = field(default_factory=dict)
    folders: Mapping[Place, Path] = field(default_factory=dict)
    problems: tuple[Problem, ...] = ()
    spoilt: frozenset[Mark] = frozenset()

    def at(self, place: Place) -> Mark:
        """Where the value stands, or the nearest thing around it that stands in the file."""
        return next(self.values[p] for p in _outwards(place) if p in self.values)

    def key_at(self, place: Place) -> Mark:
        """Where the key of this value stands, or else the value."""
        return self.keys.get(place) or self.at(place)

    def get(self, place: Place) -> Any:
        """The data at a place that exists."""
        data = self.data
        for step in place:
            data = data[step]
        return data

    def folder(self, place: Place = ()) -> Path:
        """Where relative references at this place start from."""
        return next((self.folders[p] for p in _outwards(place) if p in self.folders), Path())

    def part(self, place: Place) -> Source:
        """What stands at a place, as a source of its own; every mark keeps its file."""
        cut = len(place)
        return Source(
            self.get(place),
            {p[cut:]: mark for p, mark in self.values.items() if _within(p, place)},
            {p[cut:]: mark for p, mark in self.keys.items() if _within(p, place)},
            {(): self.folder(place)}
            | {p[cut:]: folder for p, folder in self.folders.items() if _within(p, place)},
            spoilt=self.spoilt,
        )

    def graft(self, place: Place, other: Source) -> Source:
        """This source with `other` in place of the value at `place`; every mark keeps its own file."""
        return replace(
            self,
            data=_put(self.data, place, other.data),
            values=_without(self.values, place) | {place + p: mark for p, mark in other.values.items()},
            keys={p: m for p, m in self.keys.items() if p == place or not _within(p, place)}
            | {place + p: mark for p, mark in other.keys.items()},
            folders=_without(self.folders, place)
            | {place + p: folder for p, folder in other.folders.items()},
            problems=self.problems + other.problems,
            spoilt=self.spoilt | other.spoilt,
        )

    def without(self, place: Place, problems: Iterable[Problem]) -> Source:
        """This source where the value at `place` cannot be read for these problems: nothing stands there."""
        return replace(
            self,
            data=_put(self.data, place, None),
            problems=(*self.problems, *problems),
            spoilt=self.spoilt | {self.at(place)},
        )

    def only_member(self, place: Place) -> Source:
        """This source with the value at `place` as the only member of a list; it keeps its marks."""
        member = self.part(place)
        return self.graft(
            place,
            Source(
                [member.data],
                {(): self.at(place)} | {(0, *p): mark for p, mark in member.values.items()},
                {(0, *p): mark for p, mark in member.keys.items() if p},
                {(0, *p): folder for p, folder in member.folders.items()},
            ),
        )

    def only(self, keys: Container[str]) -> Source:
        """Of a mapping what stands under these keys, each in its place; an empty one where it is none."""
        data = self.data if isinstance(self.data, dict) else {}
        return Source(
            {key: value for key, value in data.items() if key in keys},
            {p: mark for p, mark in self.values.items() if not p or p[0] in keys},
            {p: mark for p, mark in self.keys.items() if p and p[0] in keys},
            {p: folder for p, folder in self.folders.items() if not p or p[0] in keys},
            spoilt=self.spoilt,
        )


def read(path: Path, shown: str | None = None) -> Source:
    """Read a file; ConfigError when it cannot be read as one YAML document at all."""
    name = shown if shown is not None else str(path)
    return replace(_parsed(_text(path, Mark(name, 1, 1)), name), folders={(): path.parent})


@lru_cache(256)
def _parsed(text: str, name: str) -> Source:
    """Trees are read again and again in a process; what is read is never altered in place."""
    return read_text(text, name)


def read_text(text: str, name: str) -> Source:
    """Read text as one YAML document; ConfigError when it is not."""
    builder = _Builder(name)
    data = builder.value(_composed(text, name), ())
    spoilt = frozenset(builder.spoilt)
    return Source(data, builder.values, builder.keys, problems=tuple(builder.problems), spoilt=spoilt)


def _text(path: Path, start: Mark) -> str:
    try:
        if path.is_dir():
            raise ConfigError([start.problem("got a folder, expected a YAML file")])
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise ConfigError([start.problem("no such file")]) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise ConfigError([start.problem(f"cannot be read: {error}")]) from None
    if len(content) > MAX_BYTES:
        raise ConfigError([start.problem("file exceeds 1 MB, the limit for YAML input")])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line, column = _place(content[: error.start].decode("utf-8-sig"))
        message = f"got the byte 0x{content[error.start]:02x}, expected UTF-8 text"
        raise ConfigError([Problem(start.file, line, column, message)]) from None


def _place(before: str) -> tuple[int, int]:
    return before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1


def _composed(text: str, name: str) -> yaml.Node:
    try:
        node = _Loader(text).get_single_node()
    except yaml.MarkedYAMLError as error:
        raise ConfigError([_syntax_problem(error, name)]) from None
    except ReaderError as error:
        line, column = _place(text[: error.position])
        message = f"got the character {chr(error.character)!r}, which YAML does not allow"
        raise ConfigError([Problem(name, line, column, message)]) from None
    except (ValueError, OverflowError, IndexError, KeyError) as error:  # PyYAML's scanner on odd escapes
        raise ConfigError([Problem(name, 1, 1, f"not YAML: {error}")]) from None
    if node is None:
        raise ConfigError([Problem(name, 1, 1, "got an empty file, expected a YAML document")])
    return node


def _syntax_problem(error: yaml.MarkedYAMLError, name: str) -> Problem:
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    said = ", ".join(part for part in (error.context, error.problem) if part)
    if said.startswith("expected a single document"):
        said = "got a second document, expected one document in a file"
    return Problem(name, line, column, said.replace("\n", " "))


_TAGS: dict[type[yaml.Node], str] = {
    yaml.SequenceNode: BaseResolver.DEFAULT_SEQUENCE_TAG,
    yaml.MappingNode: BaseResolver.DEFAULT_MAPPING_TAG,
}


class _Loader(Reader, Scanner, Parser, Composer, BaseResolver):
    """PyYAML up to the node graph: no constructor, so no tag can make anything."""

    def __init__(self, text: str) -> None:
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        Composer.__init__(self)
        BaseResolver.__init__(self)
        self.depth = 0

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> Any:
        """No tag for a scalar that carries none: what a plain one means is decided by the core schema."""
        return _TAGS.get(kind)

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]  # untyped in the stubs
            raise yaml.MarkedYAMLError(problem=f"nested deeper than {MAX_DEPTH} levels", problem_mark=mark)
        try:
            return super().compose_node(parent, index)
        finally:
            self.depth -= 1


_CORE_TAGS = {
    tag: re.compile(pattern)
    for tag, pattern in (
        ("tag:yaml.org,2002:null", r"null|Null|NULL|~|"),
        ("tag:yaml.org,2002:bool", r"true|True|TRUE|false|False|FALSE"),
        ("tag:yaml.org,2002:int", r"[-+]?[0-9]{1,4000}|0o[0-7]{1,4000}|0x[0-9a-fA-F]{1,4000}"),
        ("tag:yaml.org,2002:float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"),
        ("tag:yaml.org,2002:special", r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"),
    )
}


class _Builder:
    """Walks the node graph once, making plain data and noting every place."""

    def __init__(self, name: str) -> None:
        self.name, self.count = name, 0
        self.values: dict[Place, Mark] = {}
        self.keys: dict[Place, Mark] = {}
        self.problems: list[Problem] = []
        self.spoilt: list[Mark] = []

    def value(self, node: yaml.Node, place: Place) -> Any:
        mark = self.mark(node)
        self.count += 1
        if self.count > MAX_NODES or len(place) > MAX_DEPTH:
            message = f"got aliases that expand to more than {MAX_NODES} values or {MAX_DEPTH} levels"
            raise ConfigError([*self.problems, mark.problem(message)])
        self.values[place] = mark
        if isinstance(node, yaml.MappingNode):
            return self.mapping(node, place)
        if isinstance(node, yaml.SequenceNode):
            self.refuse_tag(node, "tag:yaml.org,2002:seq")
            return [self.value(child, (*place, i)) for i, child in enumerate(node.value)]
        before = len(self.problems)
        scalar = self.scalar(node) if isinstance(node, yaml.ScalarNode) else None
        self.spoilt += [mark] * (len(self.problems) > before)
        return scalar

    def mapping(self, node: yaml.MappingNode, place: Place) -> dict[str, Any]:
        self.refuse_tag(node, "tag:yaml.org,2002:map")
        data: dict[str, Any] = {}
        for key_node, value_node in node.value:
            key = self.key(key_node)
            if key is None:
                continue
            if key in data:
                first = self.keys[(*place, key)].line
                message = f"got the key {key!r} a second time, expected it once (first in line {first})"
                self.problems.append(self.mark(key_node).problem(message))
                continue
            self.keys[(*place, key)] = self.mark(key_node)
            data[key] = self.value(value_node, (*place, key))
        return data

    def key(self, node: yaml.Node) -> str | None:
        key = self.scalar(node) if isinstance(node, yaml.ScalarNode) else node
        if isinstance(key, str):
            return key
        shown = node.value if isinstance(node, yaml.ScalarNode) else "a collection"
        self.problems.append(self.mark(node).problem(f"got {shown} as a key, expected text"))
        return None

    def scalar(self, node: yaml.ScalarNode) -> Any:
        text: str = node.value
        if _SURROGATE.search(text):
            message = "got half of a surrogate pair, expected a character"
            self.problems.append(self.mark(node).problem(message))
            return ""
        if node.tag is not None:
            self.refuse_tag(node, "tag:yaml.org,2002:str")
            return text
        return text if node.style is not None else self.plain(text, node)

    def plain(self, text: str, node: yaml.Node) -> Any:
        tag = next((tag for tag, pattern in _CORE_TAGS.items() if pattern.fullmatch(text)), "str")
        match tag.rpartition(":")[2]:
            case "null":
                return None
            case "bool":
                return text.lower() == "true"
            case "int":
                return int(text, {"0o": 8, "0x": 16}.get(text[:2], 10))
            case "float":
                number = float(text)
                return number if abs(number) != float("inf") else self.not_finite(text, node)
            case "special":
                return self.not_finite(text, node)
            case _:
                return text

    def not_finite(self, text: str, node: yaml.Node) -> float:
        self.problems.append(self.mark(node).problem(f"got {text[:40]}, expected a finite number"))
        return 0.0

    def refuse_tag(self, node: yaml.Node, allowed: str) -> None:
        if node.tag not in (None, "!", allowed):
            tag = node.tag.replace("tag:yaml.org,2002:", "!!")
            self.problems.append(
                self.mark(node).problem(f"got the tag {tag}, expected plain YAML without tags")
            )

    def mark(self, node: yaml.Node) -> Mark:
        start = node.start_mark
        quoted = isinstance(node, yaml.ScalarNode) and node.style in ("'", '"')
        return Mark(self.name, start.line + 1, start.column + 1, int(quoted))


_SURROGATE = re.compile("[\ud800-\udfff]")


def _outwards(place: Place) -> Iterator[Place]:
    return (place[:length] for length in range(len(place), -1, -1))


def _within(place: Place, outer: Place) -> bool:
    return place[: len(outer)] == outer


def _without(marks: Mapping[Place, Any], place: Place) -> dict[Place, Any]:
    return {p: mark for p, mark in marks.items() if not _within(p, place)}


def _put(data: Any, place: Place, value: Any) -> Any:
    """A copy of `data` with `value` at `place`, making mappings on the way; a TypeError where that fails."""
    if not place:
        return value
    step, rest = place[0], place[1:]
    if isinstance(data, list) and isinstance(step, int):
        if step >= len(data):
            raise IndexError(f"{step} is beyond the end of a list of {len(data)}")
        return [_put(old, rest, value) if i == step else old for i, old in enumerate(data)]
    if data is None:
        data = {}
    if not isinstance(data, dict):
        raise TypeError(f"{step!r} is not inside a mapping")
    return data | {str(step): _put(data.get(str(step)), rest, value)}
