"""What the core does not know it reaches by entry point; loaded on use, and loudly when that fails."""

from __future__ import annotations

import sys
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import TypeVar, overload

from executive.core.errors import PluginError

T = TypeVar("T")

BACKENDS = "longarm.backends"
STRATEGIES = "longarm.strategies"
LOCALIZERS = "longarm.localizers"
FAULTS = "longarm.faults"
COMMANDS = "longarm.commands"
FILES = "longarm.files"
POLICIES = "longarm.policies"
MODULES = "longarm.plugins"
"""Modules: the hypotheses and channels defined there are registered."""

REPORTERS = "longarm.reporters"
"""By the file that marks a folder (`campaign` for campaign.json): folder → path of the report written."""


def found(group: str) -> dict[str, EntryPoint]:
    """The registered entry points by name, none of them loaded; PluginError if a name is taken twice."""
    points: dict[str, EntryPoint] = {}
    for point in _installed(group, tuple(sys.path)):
        other = points.setdefault(point.name, point)
        if other.value != point.value:
            raise PluginError(f"{group}: {point.name!r} is registered twice: {other.value} and {point.value}")
    return points


@cache
def _installed(group: str, path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    """Those of the packages on this path, by name; a scan of all of them costs 20 ms."""
    return tuple(sorted(entry_points(group=group), key=lambda p: (p.name, p.value)))


@overload
def load(group: str, name: str) -> object: ...
@overload
def load(group: str, name: str, kind: type[T]) -> T: ...
def load(group: str, name: str, kind: type | None = None) -> object:
    """Import what `name` stands for; PluginError naming the entry point when that fails.

    `kind`, where given, is the type the object must be an instance of. KeyError: no such name.
    """
    point = found(group)[name]
    try:
        plugin: object = point.load()
    except Exception as error:  # a plug-in's import may raise anything
        raise PluginError(f"{_title(point)}: {type(error).__name__}: {error}") from error
    if kind is not None and not isinstance(plugin, kind):
        raise PluginError(f"{_title(point)}: got a {type(plugin).__name__}, expected a {kind.__name__}")
    return plugin


def _title(point: EntryPoint) -> str:
    return f"entry point {point.group}: {point.name} = {point.value}"
