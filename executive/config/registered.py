"""A name in a file that must be registered: looked up, or a problem at its place."""

from __future__ import annotations

from typing import Any, TypeVar

from executive.config.source import Mark
from executive.config.validate import guess, listed, shown
from executive.core import registry
from executive.core.errors import ConfigError, PluginError
from executive.core.registry import Kind

T = TypeVar("T")


def registered(kind: Kind[T], name: str, mark: Mark) -> T:
    """What `name` stands for; ConfigError at `mark` where it is unknown or broken (source and reason)."""
    check_registered(kind, name, mark)
    try:
        return registry.get(kind, name)
    except PluginError as error:
        raise ConfigError([mark.problem(str(error))]) from None


def check_registered(kind: Kind[Any], name: str, mark: Mark) -> None:
    """ConfigError with a guess at `mark` unless something of this name is registered; it is not loaded."""
    known = registry.names(kind)
    if name not in known:
        what = f"the unknown {kind.name} {shown(name)}"
        expected = listed(known) or f"no {kind.name} at all, since none is installed"
        raise ConfigError(
            [mark.problem(f"got {what}, expected {expected}{guess(name, known)}{not_loaded(kind)}")]
        )


def not_loaded(kind: Kind[Any] | None = None) -> str:
    """What a complaint about an unknown name adds: the plug-in modules that might have held it."""
    broken = [f"; not loaded: {module}" for module in registry.broken_modules(kind)]
    return "".join(broken)
