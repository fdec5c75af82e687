"""What the pool notes: how each strategy fared in a choice, the choice made, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Attempt:
    """One strategy tried: where, against what, and whether what had failed then went well."""

    strategy: str
    time_s: float
    hypothesis: str
    weight: float
    segment: int | None
    along_m: float | None
    helped: bool | None = None


@dataclass(frozen=True)
class Candidate:
    """How one strategy fared in a choice: its fitness, or why it was passed over."""

    name: str
    fitness: float
    refused: str | None = None


@dataclass(frozen=True)
class Choice:
    """A choice made: the strategy, or None with the reason to call home. `candidates` tells the rest."""

    time_s: float
    strategy: str | None
    hypothesis: str
    weight: float
    why: str
    candidates: tuple[Candidate, ...]
