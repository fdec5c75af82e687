"""The bank of hypotheses: reads the evidence off a comparison, and weighs by it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from executive.core.ordered_sum import ordered_sum
from executive.isc.comparison import Comparison
from executive.isc.likelihoods import Measured
from executive.isc.specs import Channel, Concern, Hypothesis

NOMINAL = "nominal"
"""All is well: on every channel the likelihood that the channel itself gives."""

NOMINAL_PRIOR, ANOMALIES_PRIOR = 0.80, 0.20  # the anomalies share theirs by their own priors
FORGETTING = 0.25  # the share that returns to the prior before each check

Weights = Mapping[str, float]


@dataclass(frozen=True)
class Evidence:
    """What one check yields: values by the names of their channels."""

    time_s: float
    channels: Mapping[str, Measured[Any]]


class HypothesisBank:
    """Hypotheses and channels, each by its name. Weights sum to 1 and include the nominal one's."""

    def __init__(self, hypotheses: Iterable[Hypothesis], channels: Iterable[Channel]) -> None:
        """ValueError without any hypothesis, and where two of them or of the channels share a name."""
        given, read = tuple(hypotheses), tuple(channels)
        self.hypotheses = {hypothesis.name: hypothesis for hypothesis in given}
        self.channels = {channel.name: channel for channel in read}
        if not given or len(self.hypotheses) < len(given) or NOMINAL in self.hypotheses:
            raise ValueError(f"got {[h.name for h in given]}, expected different hypotheses beside nominal")
        if len(self.channels) < len(read):
            raise ValueError(f"got {[c.name for c in read]}, expected different channels")
        self.prior = self._prior()

    def observe(self, comparison: Comparison) -> Evidence:
        """The channels that this comparison shows, without those that give no number."""
        seen = ((name, channel.observe(comparison)) for name, channel in self.channels.items())
        return Evidence(
            comparison.time_s, {n: value for n, value in seen if value is not None and value.finite}
        )

    def weigh(self, weights: Weights, evidence: Evidence) -> dict[str, float]:
        """The posterior weights."""
        posterior = {
            name: self._likelihood(name, evidence, (1 - FORGETTING) * weights[name] + FORGETTING * prior)
            for name, prior in self.prior.items()
        }
        return _normalised(posterior)

    def without(self, weights: Weights, refuted: Concern) -> dict[str, float]:
        """The weights after all hypotheses about one concern were refuted."""
        return _normalised({n: 0.0 if self.concern(n) is refuted else w for n, w in weights.items()})

    def concern(self, name: str) -> Concern | None:
        """What a hypothesis is about; None for the nominal one."""
        return None if name == NOMINAL else self.hypotheses[name].concerns

    def moves_as_predicted(self, name: str) -> bool:
        """Whether, if this hypothesis is true, a fix tells of a motion that the model explains."""
        return name == NOMINAL or self.concern(name) is Concern.SIGHT

    def _prior(self) -> dict[str, float]:
        total = ordered_sum(hypothesis.prior for hypothesis in self.hypotheses.values())
        shares = {n: ANOMALIES_PRIOR * h.prior / total for n, h in self.hypotheses.items()}
        return {NOMINAL: NOMINAL_PRIOR, **shares}

    def _likelihood(self, name: str, evidence: Evidence, weight: float) -> float:
        signature = {} if name == NOMINAL else self.hypotheses[name].signature
        for channel, measured in evidence.channels.items():
            weight *= signature.get(channel, self.channels[channel].nominal).likelihood(measured)
        return weight


def _normalised(weights: Weights) -> dict[str, float]:
    total = ordered_sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}
