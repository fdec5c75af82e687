"""What every hypothesis and every channel that is registered must keep."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from executive.core import registry
from executive.core.registry import Kind
from executive.isc.bank import NOMINAL
from executive.isc.likelihoods import Gaussian, Likelihood
from executive.isc.specs import Channel, Concern, Hypothesis


def broken_by_hypothesis(
    hypothesis: Hypothesis, channels: Mapping[str, Channel] | None = None
) -> Iterator[str]:
    """A sentence for each promise not kept. `channels` are those it may speak about (None: all there are)."""
    yield from _said(hypothesis.name, hypothesis.doc)
    if hypothesis.name == NOMINAL:
        yield "it is called nominal, which the classification brings itself"
    if not (math.isfinite(hypothesis.prior) and hypothesis.prior > 0):
        yield f"got the prior {hypothesis.prior}, expected more than 0"
    if not isinstance(hypothesis.concerns, Concern):
        yield f"it concerns {hypothesis.concerns!r}, expected a Concern"
    if not hypothesis.signature:
        yield "it says nothing on any channel"
    known = registry.every(CHANNEL_KIND) if channels is None else channels
    for name, likelihood in hypothesis.signature.items():
        yield from (f"on {name}: {broken}" for broken in _unsound(likelihood))
        if name not in known:
            yield f"it speaks about {name!r}, expected a channel: {', '.join(known)}"
        elif type(likelihood) is not type(known[name].nominal):
            got, expected = type(likelihood).__name__, type(known[name].nominal).__name__
            yield f"on {name}: got a {got}, expected a {expected} as when all is well"


def broken_by_channel(channel: Channel) -> Iterator[str]:
    """A sentence for each promise not kept."""
    yield from _said(channel.name, channel.doc)
    if not callable(channel.observe):
        yield f"it observes by {channel.observe!r}, expected something to call"
    yield from (f"when all is well: {broken}" for broken in _unsound(channel.nominal))


def _said(name: str, doc: str) -> Iterator[str]:
    if not name.isidentifier():
        yield f"got the name {name!r}, expected an identifier"
    if not doc.strip():
        yield "it does not say what it is (doc)"


def _unsound(likelihood: Likelihood) -> Iterator[str]:
    if isinstance(likelihood, Gaussian):
        if not (math.isfinite(likelihood.mean) and 0 < likelihood.sigma < math.inf):
            yield f"got {likelihood}, expected a finite mean and a sigma above 0"
        elif not 0 < likelihood.floor < 0.4 / likelihood.sigma:
            yield f"got the floor {likelihood.floor}, expected one between 0 and the peak of the density"
        return
    if not likelihood.values:
        yield "got no values inside, expected at least one"
    if not (0 < likelihood.inside <= 1 and 0 < likelihood.outside <= 1):
        yield f"got {likelihood.inside} inside and {likelihood.outside} outside, expected both in (0, 1]"


CHANNEL_KIND: Kind[Channel] = Kind(
    "channel",
    "channels",
    "A number or word that a check yields, as evidence.",
    Channel,
    check=broken_by_channel,
)
HYPOTHESIS_KIND: Kind[Hypothesis] = Kind(
    "hypothesis",
    "hypotheses",
    "What may be wrong, and how it would show.",
    Hypothesis,
    check=broken_by_hypothesis,
)
