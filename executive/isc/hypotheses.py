"""What may be wrong, and how each hypothesis would show: signatures over evidence channels.

A channel is one number that a check yields. A hypothesis gives a likelihood on the channels it speaks
about; on all others it takes the nominal one, so that silence neither helps nor hurts it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from executive.core.types import Reason


class Hypothesis(StrEnum):
    """Explanations that the classification weighs."""

    NOMINAL = "nominal"
    SLIP_LONGITUDINAL = "slip_longitudinal"
    SLIP_TURNING = "slip_turning"
    TRACK_ASYMMETRY = "track_asymmetry"
    SIDE_DRIFT = "side_drift"
    STUCK_ON_OBSTACLE = "stuck_on_obstacle"
    TILT_RISK = "tilt_risk"
    TETHER_SNAG = "tether_snag"
    MARKER_LOST = "marker_lost"
    POOR_VIEW = "poor_view"
    ILLUMINATION_CHANGE = "illumination_change"
    LOST_ROVER = "lost_rover"
    LOCALISATION_OUTLIER = "localisation_outlier"
    OVERSHOOT = "overshoot"
    HEAD_MISALIGNED = "head_misaligned"


SEEING = frozenset(
    {
        Hypothesis.MARKER_LOST,
        Hypothesis.POOR_VIEW,
        Hypothesis.ILLUMINATION_CHANGE,
        Hypothesis.LOST_ROVER,
    }
)
"""What may be wrong with seeing. Beside a fix that was had, these say nothing of how the rover moved."""


class Channel(StrEnum):
    """Evidence channels. Ratios are measured over predicted; z values are normalised innovations."""

    ADVANCE_RATIO = "advance_ratio"
    TURN_RATIO = "turn_ratio"
    HEADING_Z = "heading_z"
    CROSS_Z = "cross_z"
    CURRENT_RATIO = "current_ratio"
    TILT = "tilt"  # rad
    TETHER = "tether"  # N
    MARKERS = "markers"  # count used in the fix
    FAILURE = "failure"  # a Reason, see FAILURE_CODES


FAILURE_CODES: Mapping[Reason, float] = {reason: float(code) for code, reason in enumerate(Reason)}


@dataclass(frozen=True)
class Normal:
    """Gaussian likelihood with a broad floor, so that no single channel decides alone."""

    mean: float
    sigma: float
    floor: float = 1e-3

    def likelihood(self, value: float, scale: float = 0.0) -> float:
        """Density at `value`; `scale` adds the measurement's own standard deviation."""
        sigma = math.hypot(self.sigma, scale)
        return (
            math.exp(-0.5 * ((value - self.mean) / sigma) ** 2) / (sigma * math.sqrt(2 * math.pi))
            + self.floor
        )


@dataclass(frozen=True)
class Among:
    """Categorical likelihood: these values share `inside`, all others `outside`."""

    values: frozenset[float]
    inside: float
    outside: float

    def likelihood(self, value: float, scale: float = 0.0) -> float:
        return self.inside if value in self.values else self.outside


Signature = Mapping[Channel, Normal | Among]


def _failing(*reasons: Reason) -> Among:
    return Among(frozenset(FAILURE_CODES[r] for r in reasons), 0.7, 0.01)


_FOUR = frozenset({4.0})

NOMINAL: Signature = {
    Channel.ADVANCE_RATIO: Normal(1.0, 0.08),
    Channel.TURN_RATIO: Normal(1.0, 0.08),
    Channel.HEADING_Z: Normal(0.0, 1.2),
    Channel.CROSS_Z: Normal(0.0, 1.2),
    Channel.CURRENT_RATIO: Normal(1.0, 0.4),
    Channel.TILT: Normal(0.1, 0.12),
    Channel.TETHER: Normal(0.5, 1.0),
    Channel.MARKERS: Among(_FOUR, 0.95, 0.05),
    Channel.FAILURE: _failing(Reason.DONE),
}

SIGNATURES: Mapping[Hypothesis, Signature] = {
    Hypothesis.NOMINAL: NOMINAL,
    Hypothesis.SLIP_LONGITUDINAL: {
        Channel.ADVANCE_RATIO: Normal(0.55, 0.25),
    },
    Hypothesis.SLIP_TURNING: {Channel.TURN_RATIO: Normal(0.7, 0.5)},
    Hypothesis.TRACK_ASYMMETRY: {Channel.HEADING_Z: Normal(0.0, 6.0)},
    Hypothesis.SIDE_DRIFT: {Channel.CROSS_Z: Normal(0.0, 6.0), Channel.TILT: Normal(0.25, 0.12)},
    Hypothesis.STUCK_ON_OBSTACLE: {
        Channel.ADVANCE_RATIO: Normal(0.05, 0.12),
        Channel.TURN_RATIO: Normal(0.05, 0.12),
        Channel.HEADING_Z: Normal(0.0, 5.0),
        Channel.CURRENT_RATIO: Normal(1.6, 0.8),  # belts that slide draw little more than rolling ones
        Channel.FAILURE: _failing(Reason.BLOCKED),
    },
    Hypothesis.TILT_RISK: {Channel.TILT: Normal(0.55, 0.12), Channel.FAILURE: _failing(Reason.TILT)},
    Hypothesis.TETHER_SNAG: {
        Channel.TETHER: Normal(8.0, 4.0),
        Channel.ADVANCE_RATIO: Normal(0.4, 0.4),
        Channel.FAILURE: _failing(Reason.TETHER),
    },
    Hypothesis.MARKER_LOST: {
        Channel.MARKERS: Among(_FOUR, 0.05, 0.95),
        Channel.FAILURE: _failing(Reason.NOT_SEEN),
    },
    Hypothesis.POOR_VIEW: {
        Channel.MARKERS: Among(_FOUR, 0.4, 0.6),
        Channel.FAILURE: _failing(Reason.POOR_VIEW),
    },
    Hypothesis.ILLUMINATION_CHANGE: {Channel.FAILURE: _failing(Reason.UNSTABLE_IMAGES)},
    Hypothesis.LOST_ROVER: {Channel.FAILURE: _failing(Reason.NOT_SEEN, Reason.POOR_VIEW)},
    Hypothesis.LOCALISATION_OUTLIER: {
        Channel.FAILURE: _failing(Reason.IMPLAUSIBLE),
        Channel.CROSS_Z: Normal(0.0, 15.0),
        Channel.HEADING_Z: Normal(0.0, 15.0),
    },
    Hypothesis.OVERSHOOT: {
        Channel.FAILURE: _failing(Reason.OVERSHOOT),
        Channel.ADVANCE_RATIO: Normal(1.35, 0.2),
    },
    Hypothesis.HEAD_MISALIGNED: {Channel.FAILURE: _failing(Reason.MISALIGNED)},
}

PRIOR: Mapping[Hypothesis, float] = {
    h: (0.80 if h is Hypothesis.NOMINAL else 0.20 / (len(Hypothesis) - 1)) for h in Hypothesis
}


@dataclass(frozen=True)
class Evidence:
    """One check's channel values, each with its own standard deviation (0 where not known)."""

    time_s: float
    channels: Mapping[Channel, tuple[float, float]]


def weigh(
    weights: Mapping[Hypothesis, float], evidence: Evidence, forgetting: float = 0.25
) -> dict[Hypothesis, float]:
    """Posterior weights. `forgetting` is the share that returns to the prior before each check."""
    posterior: dict[Hypothesis, float] = {}
    for hypothesis, signature in SIGNATURES.items():
        weight = (1 - forgetting) * weights[hypothesis] + forgetting * PRIOR[hypothesis]
        for channel, (value, scale) in evidence.channels.items():
            if not math.isfinite(value):
                continue  # a sensor that says nothing must not spoil what the others say
            weight *= signature.get(channel, NOMINAL[channel]).likelihood(value, scale)
        posterior[hypothesis] = weight
    total = sum(posterior.values())
    return {hypothesis: weight / total for hypothesis, weight in posterior.items()}


def without(weights: Mapping[Hypothesis, float], refuted: Hypothesis) -> dict[Hypothesis, float]:
    """The weights after one hypothesis was refuted."""
    rest = {h: 0.0 if h is refuted else w for h, w in weights.items()}
    total = sum(rest.values())
    return {h: w / total for h, w in rest.items()}
