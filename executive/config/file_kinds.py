"""Kinds of files that plug-ins read: what they register under `longarm.files`, by the key that names them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from executive.config.source import Source
from executive.core import plugins


@dataclass(frozen=True)
class FileKind:
    """A kind of file: `check` raises ConfigError with every problem; `schema` is its JSON Schema."""

    name: str
    check: Callable[[Source], object]
    schema: Callable[[], dict[str, Any]]


def file_kinds() -> tuple[str, ...]:
    """The names of all that are registered, none of them loaded."""
    return tuple(sorted(plugins.found(plugins.FILES)))


def file_kind(name: str) -> FileKind:
    """One of them. PluginError when it cannot be loaded."""
    return plugins.load(plugins.FILES, name, FileKind)
