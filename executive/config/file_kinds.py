"""Kinds of files that plug-ins read: what they register under `longarm.files`, by the key that names them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from executive.config.source import Source
from executive.core import registry
from executive.core.registry import Kind


@dataclass(frozen=True)
class FileKind:
    """A kind of file: `check` raises ConfigError with every problem; `schema` is its JSON Schema.

    The key `name` tells it. Where a file has the keys of several kinds, it is of the one whose `settled_by`
    keys it has all, else of the one that none of the others `holds`: a scenario holds a mission.
    """

    name: str
    check: Callable[[Source], object]
    schema: Callable[[], dict[str, Any]]
    holds: tuple[str, ...] = ()
    settled_by: tuple[str, ...] = ()


FILE_KIND: Kind[FileKind] = Kind(
    "file kind", "files", "A kind of file that check and schema know, by the key that names it.", FileKind
)


def file_kinds() -> tuple[str, ...]:
    """The names of all that are registered, none of them loaded."""
    return registry.names(FILE_KIND)


def kind_of(data: Any) -> str | None:
    """The kind of a file with these data; none is loaded but where the keys of several are there."""
    named = [name for name in file_kinds() if isinstance(data, dict) and name in data]
    if len(named) < 2:
        return named[0] if named else None
    kinds = [file_kind(name) for name in named]
    settled = [k.name for k in kinds if k.settled_by and all(key in data for key in k.settled_by)]
    held = {name for kind in kinds for name in kind.holds}
    return next(iter([*settled, *(name for name in named if name not in held), *named]))


def file_kind(name: str) -> FileKind:
    """One of them. PluginError when it cannot be loaded."""
    return registry.get(FILE_KIND, name)
