"""The hypotheses and channels that are registered."""

from __future__ import annotations

from executive.core import registry
from executive.isc.bank import NOMINAL
from executive.isc.kind import CHANNEL_KIND, HYPOTHESIS_KIND
from executive.isc.specs import Channel, Hypothesis


def known_hypotheses() -> tuple[Hypothesis, ...]:
    """All that can be used, in order; the nominal one is the classification's own and not among them."""
    return registry.ordered(HYPOTHESIS_KIND)


def known_channels() -> tuple[Channel, ...]:
    """All that can be used, in order."""
    return registry.ordered(CHANNEL_KIND)


def hypothesis_names() -> tuple[str, ...]:
    """The names that weights have, the nominal one first."""
    return (NOMINAL, *(hypothesis.name for hypothesis in known_hypotheses()))
