"""The hypotheses and channels that are registered."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TypeVar

from executive.core import plugins
from executive.isc.bank import NOMINAL
from executive.isc.specs import Channel, Hypothesis

T = TypeVar("T")


@cache
def known_hypotheses() -> tuple[Hypothesis, ...]:
    """All that are registered, in order; the nominal one is the classification's own and not among them."""
    return tuple(_defined(Hypothesis))


@cache
def known_channels() -> tuple[Channel, ...]:
    """All that are registered, in order."""
    return tuple(_defined(Channel))


def hypothesis_names() -> tuple[str, ...]:
    """The names that weights have, the nominal one first."""
    return (NOMINAL, *(hypothesis.name for hypothesis in known_hypotheses()))


def channel_names() -> tuple[str, ...]:
    """The names that evidence has."""
    return tuple(channel.name for channel in known_channels())


def _defined(kind: type[T]) -> Iterator[T]:
    for name in plugins.found(plugins.MODULES):
        module = plugins.load(plugins.MODULES, name)
        yield from (thing for thing in vars(module).values() if isinstance(thing, kind))
