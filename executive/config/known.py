"""A name in a file that must be one of those known."""

from __future__ import annotations

from collections.abc import Sequence

from executive.config.source import Mark
from executive.config.validate import guess, listed, shown
from executive.core import plugins
from executive.core.errors import ConfigError


def check_known(at: Mark, what: str, group: str, name: str) -> None:
    """ConfigError with a guess, unless a plug-in of this name is registered in the group."""
    check_among(at, f"a {what}", name, sorted(plugins.found(group)))


def check_among(at: Mark, what: str, name: str, known: Sequence[str]) -> None:
    """ConfigError with a guess, unless `name` is among those known; `what` says what they are."""
    if name not in known:
        raise ConfigError(
            [at.problem(f"got {shown(name)}, expected {what}: {listed(known)}{guess(name, known)}")]
        )
