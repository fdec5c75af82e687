"""What the classification makes of the evidence."""

from __future__ import annotations

from dataclasses import dataclass

from executive.isc.bank import NOMINAL, Evidence, Weights


@dataclass(frozen=True)
class Assessment:
    """The weights, the likeliest anomaly, and where this leads.

    `time_to_margin_s` is when, going on as now, the off-track margin would be crossed; None for never.
    """

    time_s: float
    weights: Weights
    time_to_margin_s: float | None = None
    evidence: Evidence | None = None

    @property
    def likeliest(self) -> str:
        return max(self.weights, key=lambda name: self.weights[name])

    @property
    def anomaly(self) -> tuple[str, float]:
        """The likeliest hypothesis other than nominal, and its weight."""
        others = {name: weight for name, weight in self.weights.items() if name != NOMINAL}
        best = max(others, key=lambda name: others[name])
        return best, others[best]
