"""The pool of strategies: what each answers, needs, risks and costs; which is tried next, and why.

Paper, section 3.3: the first-fitted strategy is tried and its effect verified; the cost is in proportion to
the quality asked and inverse to the remaining error; when the answer is risky or ambiguous, call home.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from executive.core.errors import StrategyRaised
from executive.core.types import (
    CabinReading,
    Outcome,
    PoseEstimate,
    Reason,
    Segment,
)
from executive.isc.classification import Assessment
from executive.isc.hypotheses import Hypothesis

AMBIGUITY = 0.8  # a second anomaly this close to the first is a tie
LEAST_WEIGHT = 0.02  # a hypothesis below this is no reason to act
LEAST_FITNESS = 0.1  # below this a remedy is a shot in the dark; ground decides better
SAME_PLACE_M = 0.15
PROGRESS_M = 0.05
NONE_UNFIT: Mapping[str, str] = {}


@dataclass(frozen=True)
class Situation:
    """All that a choice may rest on."""

    time_s: float
    failure: Outcome[object]
    assessment: Assessment
    pose: PoseEstimate
    segment: Segment | None
    cabin: CabinReading | None = None


def no_needs(situation: Situation) -> str | None:
    """The `needs` of a strategy that has none."""
    return None


@dataclass(frozen=True)
class Strategy:
    """A recovery method. A plug-in offers one under the entry point group `longarm.strategies`.

    `answers` says how well (0..1) it answers each hypothesis, `reasons` likewise each failure reason.
    `needs` returns why it cannot be tried now, None if it can. `excursion_m` is how far from here it may
    take the rover, `cost_s` the mission time it takes. `tree` is its sub-tree (YAML), whose ports bind to
    the same-named values of the tree that recovers. `opposes` names strategies whose remedy conflicts.
    """

    name: str
    doc: str
    tree: Path
    answers: Mapping[Hypothesis, float]
    reasons: Mapping[Reason, float]
    cost_s: float
    excursion_m: float = 0.0
    tries_per_segment: int = 2
    needs: Callable[[Situation], str | None] = no_needs
    opposes: frozenset[str] = frozenset()


@dataclass
class Attempt:
    """One strategy tried: where, against what, and whether what had failed then went well."""

    strategy: str
    time_s: float
    hypothesis: Hypothesis
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
    hypothesis: Hypothesis
    weight: float
    why: str
    candidates: tuple[Candidate, ...]


class Pool:
    """Strategies and the memory of what was tried where."""

    def __init__(
        self,
        strategies: Iterable[Strategy],
        note: Callable[[Choice | Attempt], None],
        unfit: Mapping[str, str] = NONE_UNFIT,
    ) -> None:
        """`unfit` says of strategies that this robot cannot carry out why not, by name."""
        self.strategies: dict[str, Strategy] = {s.name: s for s in strategies}
        self.unfit = unfit
        self.attempts: list[Attempt] = []
        self._note = note

    def choose(self, situation: Situation, at_hand: Container[str] | None = None) -> Choice:
        """The first-fitted strategy for this situation, of those `at_hand` where the tree stands (None: all).

        The choice is noted, and an attempt opened.
        """
        anomaly, weight = situation.assessment.anomaly
        candidates = tuple(
            sorted(
                (self._rate(s, situation, at_hand) for s in self.strategies.values()),
                key=lambda c: -c.fitness,
            )
        )
        fit = [c for c in candidates if c.refused is None]
        choice = Choice(
            situation.time_s,
            *self._decide(fit, situation, anomaly, weight),
            candidates=candidates,
        )
        self._note(choice)
        if choice.strategy is not None:
            offset = situation.pose.on(situation.segment).track
            self.attempts.append(
                Attempt(
                    choice.strategy,
                    situation.time_s,
                    choice.hypothesis,
                    choice.weight,
                    situation.segment.index if situation.segment else None,
                    offset.along_m if offset else None,
                )
            )
        return choice

    def conclude(self, helped: bool, along_m: float | None = None) -> None:
        """Close the open attempt: what had failed now went well, or failed again.

        What fails again only after a piece of way, `along_m` the place along the segment, was helped.
        """
        if not self.attempts or self.attempts[-1].helped is not None:
            return
        attempt = self.attempts[-1]
        got_on = (
            along_m is not None and attempt.along_m is not None and along_m - attempt.along_m > PROGRESS_M
        )
        attempt.helped = helped or got_on
        self._note(attempt)

    def _decide(
        self, fit: list[Candidate], situation: Situation, anomaly: Hypothesis, weight: float
    ) -> tuple[str | None, Hypothesis, float, str]:
        if not fit:
            return None, anomaly, weight, "no strategy fits"
        best = self.strategies[fit[0].name]
        for other in fit[1:]:
            if other.name in best.opposes and other.fitness > AMBIGUITY * fit[0].fitness:
                return None, anomaly, weight, f"{best.name} and {other.name} fit alike and conflict"
        answered = max(best.answers, key=lambda h: best.answers[h] * situation.assessment.weights[h])
        return (
            best.name,
            answered,
            situation.assessment.weights[answered],
            f"answers {answered} and {situation.failure.reason}; cost {best.cost_s:.0f} s",
        )

    def _rate(self, strategy: Strategy, situation: Situation, at_hand: Container[str] | None) -> Candidate:
        if strategy.name in self.unfit:
            return Candidate(strategy.name, 0.0, self.unfit[strategy.name])
        if at_hand is not None and strategy.name not in at_hand:
            return Candidate(strategy.name, 0.0, "needs values that the tree here does not have")
        weights = situation.assessment.weights
        explained = sum(weights[h] * a for h, a in strategy.answers.items() if weights[h] >= LEAST_WEIGHT)
        fitness = explained + strategy.reasons.get(situation.failure.reason, 0.0)
        if fitness < LEAST_FITNESS:
            return Candidate(strategy.name, fitness, "does not answer what is likely")
        fitness /= 1 + strategy.cost_s / self._worthwhile_s(situation)
        return Candidate(strategy.name, fitness, self._refusal(strategy, situation))

    @staticmethod
    def _worthwhile_s(situation: Situation) -> float:
        """The cost that halves a strategy's fitness: much remains to be driven, then little is worth it."""
        offset = situation.pose.on(situation.segment).track
        remaining_m = offset.remaining_m if offset else 1.0
        return 1200.0 / (1.0 + remaining_m)

    def _refusal(self, strategy: Strategy, situation: Situation) -> str | None:
        segment, offset = situation.segment, situation.pose.on(situation.segment).track
        if segment is not None and offset is not None:
            if abs(offset.cross_m) >= segment.off_track_m:
                return "beyond the off-track margin any autonomous correction is forbidden"
            room = segment.off_track_m - abs(offset.cross_m) - 2 * situation.pose.sigma_across_m(segment)
            if strategy.excursion_m > max(room, 0.0):  # to stay where it is a rover needs no room
                return f"may leave the margin: needs {strategy.excursion_m:.2f} m, has {room:.2f} m"
        if self._tried_here(strategy.name, segment, offset.along_m if offset else None):
            return "did not help here before"
        tries = [a for a in self.attempts if a.strategy == strategy.name]
        tries = [a for a in tries if segment is None or a.segment == segment.index]
        if len(tries) >= strategy.tries_per_segment:
            return f"tried {len(tries)} times on this segment"
        try:
            return strategy.needs(situation)
        except Exception as error:
            raise StrategyRaised(strategy.name, error) from error

    def _tried_here(self, name: str, segment: Segment | None, along_m: float | None) -> bool:
        return any(
            a.strategy == name
            and a.helped is False
            and a.segment == (segment.index if segment else None)
            and (a.along_m is None or along_m is None or abs(a.along_m - along_m) < SAME_PLACE_M)
            for a in self.attempts
        )
