"""Likelihoods: how probable a measured value is under a hypothesis, for numbers and for categories."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

T = TypeVar("T", bound=Hashable)


@dataclass(frozen=True)
class Measured(Generic[T]):
    """A value on a channel, and its own standard deviation (0 where not known, or no number)."""

    value: T
    sigma: float = 0.0

    @property
    def finite(self) -> bool:
        """Whether it says anything: a sensor that gives no number must not spoil what the others say."""
        return not isinstance(self.value, float) or math.isfinite(self.value)


@dataclass(frozen=True)
class Gaussian:
    """Normal density with a constant floor, so that no single channel decides alone."""

    mean: float
    sigma: float
    floor: float = 1e-3

    def likelihood(self, measured: Measured[float]) -> float:
        """Density at the value, the measurement's own spread added to this one's."""
        sigma = math.hypot(self.sigma, measured.sigma)
        z = (measured.value - self.mean) / sigma
        return math.exp(-0.5 * z**2) / (sigma * math.sqrt(2 * math.pi)) + self.floor


@dataclass(frozen=True)
class Categorical(Generic[T]):
    """Each of `values` has the likelihood `inside`, every other value `outside`."""

    values: frozenset[T]
    inside: float
    outside: float

    def likelihood(self, measured: Measured[T]) -> float:
        return self.inside if measured.value in self.values else self.outside


Likelihood = Gaussian | Categorical[Any]
