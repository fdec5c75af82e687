"""The hypotheses and channels that are registered."""

from __future__ import annotations

from collections.abc import Collection

from executive.core import registry
from executive.isc.bank import NOMINAL
from executive.isc.kind import CHANNEL_KIND, HYPOTHESIS_KIND
from executive.isc.specs import Channel, Hypothesis


def known_hypotheses(devices: Collection[str] | None = None) -> tuple[Hypothesis, ...]:
    """All that can be used, in order; of a robot with these devices (None: of any).

    The nominal one is the classification's own and not among them.
    """
    return tuple(h for h in registry.ordered(HYPOTHESIS_KIND) if _fits(h.needs, devices))


def known_channels(devices: Collection[str] | None = None) -> tuple[Channel, ...]:
    """All that can be used, in order; of a robot with these devices (None: of any)."""
    return tuple(channel for channel in registry.ordered(CHANNEL_KIND) if _fits(channel.needs, devices))


def _fits(needs: tuple[str, ...], devices: Collection[str] | None) -> bool:
    return devices is None or all(name in devices for name in needs)


def hypothesis_names() -> tuple[str, ...]:
    """The names that weights have, the nominal one first."""
    return (NOMINAL, *(hypothesis.name for hypothesis in known_hypotheses()))
