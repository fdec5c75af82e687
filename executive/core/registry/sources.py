"""Where entries come from: entry points of installed packages, modules of them, files of the project."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from types import ModuleType
from typing import Any, TypeVar, cast

from executive.core.errors import PluginError
from executive.core.registry.entry import Broken, Entry, why
from executive.core.registry.kind import Kind, group_of
from executive.core.registry.modules import added_to_path, defined_in, load_file
from executive.core.registry.project import Project, current_project

KINDS = group_of("kinds")
MODULES = group_of("plugins")
"""Entry points of this group name modules, which are scanned as a project's files are."""
OF_KINDS: Kind[Kind[Any]] = Kind(
    "kind", "kinds", "What can be added.", Kind, name_of=lambda kind: kind.plural
)
T = TypeVar("T")
Entries = dict[str, Entry]


@dataclass(frozen=True)
class Module:
    """A module scanned: what it adds, by kind, or why it could not be imported."""

    source: str
    adds: dict[str, Entries]
    broken: Broken | None = None


def entries(plural: str) -> Entries:
    """Everything registered of one kind, by name; nothing of it is loaded but modules that are scanned."""
    return dict(sorted(in_order(plural).items()))


def in_order(plural: str) -> Entries:
    """The same in order of registration: entry points by name, then modules as they define it."""
    found = dict(_installed(_path()).get(group_of(plural), {}))
    for module in modules(plural):
        for name, entry in module.adds.get(plural, {}).items():
            found[name] = _twice(found[name], entry) if name in found else entry
    return found


def modules(plural: str | None = None) -> tuple[Module, ...]:
    """The plug-in modules of packages and of the project under way, scanned: all, or those for one kind.

    The last word of an entry point's name may be the plural of a kind (`mine.channels`): then the module is
    imported and scanned for that kind alone.
    """
    points = _installed(_path()).get(MODULES, {})
    wanted = [name for name in points if plural is None or _only(name) in (None, plural)]
    return (*(_of_package(_path(), name) for name in wanted), *_of_project(_path(), current_project()))


def kinds() -> tuple[Kind[Any], ...]:
    """Every kind there is, loaded; one that cannot be is left out."""
    return _kinds(_path())[0]


def broken_kinds() -> tuple[Broken, ...]:
    """The kinds that cannot be loaded."""
    return _kinds(_path())[1]


def kind_named(plural: str) -> Kind[Any]:
    """One kind, and no other loaded. KeyError: no such kind; PluginError: it is broken."""
    return cast("Kind[Any]", _installed(_path())[KINDS][plural].use(OF_KINDS))


def kind_names() -> tuple[str, ...]:
    """The plurals of the kinds, none of them loaded."""
    return tuple(sorted(_installed(_path()).get(KINDS, {})))


def _path() -> tuple[str, ...]:
    return tuple(folder for folder in sys.path if folder not in added_to_path)


@cache
def _installed(path: tuple[str, ...]) -> dict[str, Entries]:
    """The entry points of the packages on this path, by group; to read them all takes 20 ms."""
    found: dict[str, Entries] = {}
    installed = entry_points()
    for group in sorted(name for name in installed.groups if name.startswith("longarm.")):
        of_group = found.setdefault(group, {})
        for point in sorted(installed.select(group=group), key=lambda p: (p.name, p.value)):
            entry = _of_point(point)
            other = of_group.setdefault(point.name, entry)
            if other.source != entry.source:
                of_group[point.name] = _twice(other, entry)
    return found


def _of_point(point: EntryPoint) -> Entry:
    load = partial(import_module, point.module) if point.group == MODULES else point.load
    kind = point.group.removeprefix("longarm.")
    return Entry(kind, point.name, _title(point), load, partial(_package, point))


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist is not None else point.module


def _title(point: EntryPoint) -> str:
    return f"entry point {point.group}: {point.name} = {point.value}"


def _twice(first: Entry, second: Entry) -> Entry:
    """Stands for a name that two things claim: neither can be used, whichever was meant."""

    def refuse() -> object:
        raise PluginError(f"registered twice, also by {second.source}")

    return Entry(first.kind, first.name, first.source, refuse, first.origin)


@cache
def _kinds(path: tuple[str, ...]) -> tuple[tuple[Kind[Any], ...], tuple[Broken, ...]]:
    tried = [entry.loaded(OF_KINDS) for entry in _installed(path).get(KINDS, {}).values()]
    loaded = tuple(cast("Kind[Any]", thing) for thing, broken in tried if broken is None)
    return loaded, tuple(broken for _, broken in tried if broken is not None)


def _only(point: str) -> str | None:
    """The one kind that a module is scanned for; None for every kind."""
    last = point.rpartition(".")[2]
    return last if last in kind_names() else None


@cache
def _of_package(path: tuple[str, ...], name: str) -> Module:
    entry, only = _installed(path)[MODULES][name], _only(name)
    return _scan(entry.source, cast("Callable[[], ModuleType]", entry.load), only)


@cache
def _of_project(path: tuple[str, ...], project: Project | None) -> tuple[Module, ...]:
    if project is None:
        return ()
    return tuple(_scan(project.title(plugin), partial(load_file, plugin)) for plugin in project.plugins)


def _same(thing: T) -> T:
    return thing


def _scan(source: str, load: Callable[[], ModuleType], only: str | None = None) -> Module:
    try:
        module = load()
        found = list(defined_in(module, kinds() if only is None else (kind_named(only),)))
    except Exception as error:  # a plug-in's import may raise anything
        return Module(source, {}, Broken("plug-in", "", source, why(error)))
    adds: dict[str, Entries] = {}
    for kind, name, thing in found:
        of_kind = adds.setdefault(kind.plural, {})
        entry = Entry(kind.plural, name, source, partial(_same, thing), partial(_same, source))
        of_kind[name] = _twice(of_kind[name], entry) if name in of_kind else entry
    return Module(source, adds)
