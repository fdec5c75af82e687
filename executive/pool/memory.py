"""What was tried where, and whether it helped."""

from __future__ import annotations

from dataclasses import dataclass, field

from executive.core.types import Segment
from executive.pool.choice import Attempt, Choice
from executive.pool.situation import Situation

SAME_PLACE_M = 0.15
PROGRESS_M = 0.05


@dataclass
class Memory:
    """The attempts of this run, oldest first."""

    attempts: list[Attempt] = field(default_factory=list)

    def open(self, strategy: str, choice: Choice, situation: Situation) -> None:
        """Remember that a strategy is being tried."""
        self.attempts.append(
            Attempt(
                strategy,
                situation.time_s,
                choice.hypothesis,
                choice.weight,
                _index(situation.segment),
                situation.along_m,
            )
        )

    def close(self, helped: bool, along_m: float | None = None) -> Attempt | None:
        """Close the open attempt and return it; None if there is none.

        What fails again only after a piece of way, `along_m` the place along the segment, was helped.
        """
        if not self.attempts or self.attempts[-1].helped is not None:
            return None
        attempt = self.attempts[-1]
        got_on = (
            along_m is not None and attempt.along_m is not None and along_m - attempt.along_m > PROGRESS_M
        )
        attempt.helped = helped or got_on
        return attempt

    def tries(self, strategy: str, segment: Segment | None) -> int:
        """How often a strategy was tried on a segment; without one, at all."""
        tried = [a for a in self.attempts if a.strategy == strategy]
        return len([a for a in tried if segment is None or a.segment == segment.index])

    def failed_here(self, strategy: str, situation: Situation) -> bool:
        """Whether a strategy was tried near this place and did not help."""
        along_m = situation.along_m
        return any(
            a.strategy == strategy
            and a.helped is False
            and a.segment == _index(situation.segment)
            and (a.along_m is None or along_m is None or abs(a.along_m - along_m) < SAME_PLACE_M)
            for a in self.attempts
        )

    @property
    def last(self) -> str | None:
        """The strategy tried last, None before the first."""
        return self.attempts[-1].strategy if self.attempts else None


def _index(segment: Segment | None) -> int | None:
    return segment.index if segment else None
