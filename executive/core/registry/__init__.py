"""One registry for everything that can be added, built-in or foreign.

    registry.names(STRATEGY_KIND)            what is registered, nothing of it loaded
    registry.get(STRATEGY_KIND, "back_off")  one, imported and checked when first used
    registry.every(STRATEGY_KIND)            all that can be used, by name
    registry.broken(STRATEGY_KIND)           what cannot, with source and reason

Entries come from three sources: entry points of the group of their kind, one object each; modules that
entry points of `longarm.plugins` name; and the `plugins:` files of the project's `longarm.yaml`. What is
broken is named with its source, and only what uses it fails.
"""

from __future__ import annotations

from typing import Any, TypeVar, cast

from executive.core.registry.entry import Broken
from executive.core.registry.kind import Kind, own_name
from executive.core.registry.project import PROJECT_FILE, Project, current_project, in_project, project_file
from executive.core.registry.sources import (
    Module,
    broken_kinds,
    entries,
    in_order,
    kind_named,
    kind_names,
    kinds,
    modules,
)

__all__ = [
    "PROJECT_FILE",
    "Broken",
    "Kind",
    "Module",
    "Project",
    "broken",
    "broken_kinds",
    "broken_modules",
    "current_project",
    "entries",
    "every",
    "get",
    "in_project",
    "kind_named",
    "kind_names",
    "kinds",
    "modules",
    "names",
    "ordered",
    "own_name",
    "project_file",
    "source_of",
]

T = TypeVar("T")


def names(kind: Kind[Any]) -> tuple[str, ...]:
    """The names registered, sorted; what stands behind one may still turn out to be broken."""
    return tuple(entries(kind.plural))


def get(kind: Kind[T], name: str) -> T:
    """What `name` stands for. KeyError: no such name; PluginError: it is broken, with source and reason."""
    return cast("T", entries(kind.plural)[name].use(kind))


def every(kind: Kind[T]) -> dict[str, T]:
    """All of a kind that can be used, by name."""
    loaded = {name: entry.loaded(kind) for name, entry in entries(kind.plural).items()}
    return {name: cast("T", thing) for name, (thing, broken) in loaded.items() if broken is None}


def ordered(kind: Kind[T]) -> tuple[T, ...]:
    """All of a kind that can be used, in the order in which it is registered."""
    loaded = [entry.loaded(kind) for entry in in_order(kind.plural).values()]
    return tuple(cast("T", thing) for thing, broken in loaded if broken is None)


def broken(kind: Kind[Any]) -> tuple[Broken, ...]:
    """All of a kind that cannot be used, and the modules that may have held more of it."""
    loaded = [entry.loaded(kind) for entry in entries(kind.plural).values()]
    return (*(found for _, found in loaded if found is not None), *broken_modules(kind))


def broken_modules(kind: Kind[Any] | None = None) -> tuple[Broken, ...]:
    """The plug-in modules that cannot be imported, which might have added this kind, or any."""
    found = modules(kind.plural if kind is not None else None)
    return tuple(module.broken for module in found if module.broken is not None)


def source_of(kind: Kind[Any], name: str) -> str:
    """Where an entry comes from, as messages say it."""
    return entries(kind.plural)[name].source
