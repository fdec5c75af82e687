"""A recovery method, as the pool knows it: what it answers, needs, risks and costs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from executive.core.types import Reason
from executive.pool.situation import Situation


def no_needs(situation: Situation) -> str | None:
    """The `needs` of a strategy that has none."""
    return None


@dataclass(frozen=True)
class Strategy:
    """A recovery method. A plug-in offers one under the entry point group `longarm.strategies`.

    `answers` says how well (0..1) it answers each hypothesis, by name, `reasons` likewise each reason of
    failure. `needs` returns why it cannot be tried now, None if it can. `excursion_m` is how far from here it
    may take the rover, `cost_s` the mission time it takes. `tree` is its sub-tree (YAML), whose ports bind to
    the same-named values of the tree that recovers. `opposes` names strategies whose remedy conflicts.
    """

    name: str
    doc: str
    tree: Path
    answers: Mapping[str, float]
    reasons: Mapping[Reason, float]
    cost_s: float
    excursion_m: float = 0.0
    tries_per_segment: int = 2
    needs: Callable[[Situation], str | None] = no_needs
    opposes: frozenset[str] = frozenset()
