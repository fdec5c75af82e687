"""Intervals and tests for shares and paired differences. All intervals are 95 %."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

CONFIDENCE = 0.95
_RESAMPLES = 5000


@dataclass(frozen=True)
class Estimate:
    """A value and the ends of its interval; NaN where there is nothing to estimate from."""

    value: float
    low: float
    high: float


def share(hits: int, total: int) -> Estimate:
    """A share with its Wilson score interval, which holds at 0 and 1 and for few cases."""
    if total == 0:
        return Estimate(math.nan, math.nan, math.nan)
    interval = stats.binomtest(hits, total).proportion_ci(CONFIDENCE, method="wilson")
    return Estimate(hits / total, float(interval.low), float(interval.high))


@dataclass(frozen=True)
class Pairs:
    """How often both, only one, or neither of two settings succeeded under the same conditions."""

    both: int
    only_first: int
    only_second: int
    neither: int

    @classmethod
    def of(cls, outcomes: Sequence[tuple[bool, bool]]) -> Pairs:
        """Count (first, second) successes."""
        return cls(*(outcomes.count(kind) for kind in _KINDS))

    @property
    def total(self) -> int:
        return self.both + self.only_first + self.only_second + self.neither

    def p_value(self) -> float:
        """McNemar's exact test: how likely so lopsided a split of the discordant pairs is by chance."""
        discordant = self.only_first + self.only_second
        if discordant == 0:
            return 1.0
        return float(stats.binomtest(self.only_first, discordant, 0.5).pvalue)

    def difference(self) -> Estimate:
        """Share of the second minus share of the first, Newcombe's interval for paired shares (method 10).

        R. G. Newcombe, Statistics in Medicine 17 (1998) 2635-2650. Unlike a bootstrap it has a width even
        where no pair disagrees.
        """
        n = self.total
        if n == 0:
            return Estimate(math.nan, math.nan, math.nan)
        first = share(self.both + self.only_first, n)
        second = share(self.both + self.only_second, n)
        below_1, above_1 = first.value - first.low, first.high - first.value
        below_2, above_2 = second.value - second.low, second.high - second.value
        phi = self._correlation()
        low = math.sqrt(max(below_2**2 - 2 * phi * below_2 * above_1 + above_1**2, 0.0))
        high = math.sqrt(max(above_2**2 - 2 * phi * above_2 * below_1 + below_1**2, 0.0))
        value = second.value - first.value
        return Estimate(value, value - low, value + high)

    def _correlation(self) -> float:
        """Newcombe's phi: with his continuity correction where positive, 0 where a margin is empty."""
        a, b, c, d = self.both, self.only_first, self.only_second, self.neither
        margins = (a + b) * (c + d) * (a + c) * (b + d)
        if margins == 0:
            return 0.0
        cross = a * d - b * c
        corrected = max(cross - self.total / 2, 0.0) if cross > 0 else float(cross)
        return corrected / math.sqrt(margins)


_KINDS = ((True, True), (True, False), (False, True), (False, False))


def median(values: Sequence[float], rng: np.random.Generator) -> Estimate:
    """The median with its bootstrap percentile interval; the same generator gives the same interval."""
    data = np.asarray(values, dtype=np.float64)
    if data.size == 0:
        return Estimate(math.nan, math.nan, math.nan)
    middle = float(np.median(data))
    if data.size < 2 or np.ptp(data) == 0.0:
        return Estimate(middle, middle, middle)
    found = stats.bootstrap(
        (data,),
        np.median,
        confidence_level=CONFIDENCE,
        n_resamples=_RESAMPLES,
        method="percentile",
        rng=rng,
    )
    return Estimate(middle, float(found.confidence_interval.low), float(found.confidence_interval.high))
