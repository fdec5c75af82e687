"""XML text → elements that know where they and their attributes stand. No entities, no includes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from executive.config.find import shown
from executive.config.source import MAX_BYTES, MAX_DEPTH, Mark
from executive.core.errors import ConfigError


@dataclass
class Tag:
    """An element: name, attributes in the order given, children, and the places of all of them."""

    name: str
    mark: Mark
    attributes: dict[str, str]
    places: dict[str, Mark]
    children: list[Tag] = field(default_factory=list)
    text: str = ""

    def at(self, attribute: str) -> Mark:
        """Where an attribute's value stands, or else the element."""
        return self.places.get(attribute, self.mark)

    def named(self, name: str) -> Iterator[Tag]:
        """The children of this name."""
        return (child for child in self.children if child.name == name)


def read_markup(path: Path) -> Tag:
    """The root element of a file; ConfigError where it cannot be read or is not well formed."""
    start = Mark(shown(path.absolute()), 1, 1)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ConfigError([start.problem(f"cannot be read: {error.strerror}")]) from None
    if len(content) > MAX_BYTES:
        raise ConfigError([start.problem("file exceeds 1 MB, the limit for XML input")])
    return _Reader(start.file, content).read()


class _Reader:
    """Drives expat, which knows where it is, and keeps the stack of open elements."""

    def __init__(self, file: str, content: bytes) -> None:
        self.file, self.content = file, content
        self.stack: list[Tag] = []
        self.root: Tag | None = None
        self.parser = expat.ParserCreate()
        self.parser.ordered_attributes = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = lambda name: self.stack.pop()
        self.parser.CharacterDataHandler = self._text
        self.parser.EntityDeclHandler = self._entity

    def read(self) -> Tag:
        try:
            self.parser.Parse(self.content, True)
        except expat.ExpatError as error:
            mark = Mark(self.file, error.lineno, error.offset + 1)
            message = f"not well-formed XML: {expat.ErrorString(error.code)}"
            raise ConfigError([mark.problem(message)]) from None
        if self.root is None:
            raise ConfigError([Mark(self.file, 1, 1).problem("got an empty file, expected XML")])
        return self.root

    def _mark(self) -> Mark:
        return Mark(self.file, self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)

    def _start(self, name: str, flat: list[str]) -> None:
        attributes = dict(zip(flat[::2], flat[1::2], strict=True))
        tag = Tag(name, self._mark(), attributes, self._places(attributes))
        if self.stack:
            self.stack[-1].children.append(tag)
        else:
            self.root = tag
        self.stack.append(tag)
        if len(self.stack) > MAX_DEPTH:
            raise ConfigError([tag.mark.problem(f"nested deeper than {MAX_DEPTH} levels")])

    def _text(self, text: str) -> None:
        if self.stack:
            self.stack[-1].text += text

    def _entity(self, *declaration: object) -> None:
        raise ConfigError([self._mark().problem("got an entity declaration, expected plain XML without")])

    def _places(self, attributes: dict[str, str]) -> dict[str, Mark]:
        """Where each attribute's value stands in the start tag that the parser is at."""
        start = self.parser.CurrentByteIndex
        head = self.content[start : self.content.find(b">", start) + 1].decode(errors="replace")
        line, column = self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1
        places = {}
        for name in attributes:
            found = re.search(rf"\s{re.escape(name)}\s*=\s*[\"']", head)
            if found is not None:
                before = head[: found.end()]
                lines = before.count("\n")
                across = len(before) - before.rfind("\n") if lines else column + len(before)
                places[name] = Mark(self.file, line + lines, across)
        return places
