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
    """A kind of file: `check` raises ConfigError with every problem; `schema` is its JSON Schema."""

    name: str
    check: Callable[[Source], object]
    schema: Callable[[], dict[str, Any]]


FILE_KIND: Kind[FileKind] = Kind(
    "file kind", "files", "A kind of file that check and schema know, by the key that names it.", FileKind
)


def file_kinds() -> tuple[str, ...]:
    """The names of all that are registered, none of them loaded."""
    return registry.names(FILE_KIND)


def file_kind(name: str) -> FileKind:
    """One of them. PluginError when it cannot be loaded."""
    return registry.get(FILE_KIND, name)
