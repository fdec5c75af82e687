"""The pool of strategies: which is tried next, and why.

Paper, section 3.3: the first-fitted strategy is tried and its effect verified; the cost is in proportion to
the quality asked and inverse to the remaining error; when the answer is risky or ambiguous, call home.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping

from executive.pool.choice import Attempt, Candidate, Choice
from executive.pool.memory import Memory
from executive.pool.policies import FIRST_FITTED, Decision, Option, Policy
from executive.pool.rating import LEAST_FITNESS, refusal, relevance, worthwhile_s
from executive.pool.situation import Situation
from executive.pool.strategy import Strategy

NONE_UNFIT: Mapping[str, str] = {}


class Pool:
    """Strategies, the policy that chooses among them, and the memory of what was tried where."""

    def __init__(
        self,
        strategies: Iterable[Strategy],
        note: Callable[[Choice | Attempt], None],
        policy: Policy = FIRST_FITTED,
        unfit: Mapping[str, str] = NONE_UNFIT,
    ) -> None:
        """`unfit` says of strategies that this robot cannot carry out why not, by name."""
        self.strategies: dict[str, Strategy] = {s.name: s for s in strategies}
        self.memory = Memory()
        self.policy, self.unfit = policy, unfit
        self._note = note

    def choose(self, situation: Situation, at_hand: Container[str] | None = None) -> Choice:
        """The policy's choice for this situation, of those `at_hand` where the tree stands (None: all).

        The choice is noted, and an attempt opened.
        """
        rated = (self._rate(s, situation, at_hand) for s in self.strategies.values())
        candidates = tuple(sorted(rated, key=lambda c: -c.fitness))
        options = [Option(self.strategies[c.name], c.fitness) for c in candidates if c.refused is None]
        decision = Decision(None, "no strategy fits")
        if options:
            decision = self.policy.choose(options, situation, self.memory)
        choice = _choice(decision, situation, candidates)
        self._note(choice)
        if choice.strategy is not None:
            self.memory.open(choice.strategy, choice, situation)
        return choice

    def conclude(self, helped: bool, along_m: float | None = None) -> None:
        """Close the open attempt: what had failed now went well, or failed again.

        What fails again only after a piece of way, `along_m` the place along the segment, was helped.
        """
        attempt = self.memory.close(helped, along_m)
        if attempt is not None:
            self._note(attempt)

    def _rate(self, strategy: Strategy, situation: Situation, at_hand: Container[str] | None) -> Candidate:
        if strategy.name in self.unfit:
            return Candidate(strategy.name, 0.0, self.unfit[strategy.name])
        if at_hand is not None and strategy.name not in at_hand:
            return Candidate(strategy.name, 0.0, "needs values that the tree here does not have")
        fitness = relevance(strategy, situation)
        if self.policy.heeds_fitness and fitness < LEAST_FITNESS:
            return Candidate(strategy.name, fitness, "does not address a likely cause")
        fitness /= 1 + strategy.cost_s / worthwhile_s(situation)
        return Candidate(strategy.name, fitness, refusal(strategy, situation, self.memory))


def _choice(decision: Decision, situation: Situation, candidates: tuple[Candidate, ...]) -> Choice:
    weights, strategy = situation.assessment.weights, decision.strategy
    if strategy is None:
        return Choice(situation.time_s, None, *situation.assessment.anomaly, decision.why, candidates)
    answered, weight = situation.assessment.anomaly
    if strategy.answers:
        answered = max(strategy.answers, key=lambda h: strategy.answers[h] * weights[h])
        weight = weights[answered]
    why = f"answers {answered} and {situation.failure.reason}; cost {strategy.cost_s:.0f} s"
    return Choice(situation.time_s, strategy.name, answered, weight, decision.why or why, candidates)
