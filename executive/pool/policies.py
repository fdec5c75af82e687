"""Selection policies: which of the strategies that may be tried is tried."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from executive.pool.memory import Memory
from executive.pool.situation import Situation
from executive.pool.strategy import Strategy

AMBIGUITY = 0.8  # a second strategy this close to the first is a tie


@dataclass(frozen=True)
class Option:
    """A strategy that nothing forbids, and its fitness."""

    strategy: Strategy
    fitness: float


@dataclass(frozen=True)
class Decision:
    """The strategy to try; None to call home, and why."""

    strategy: Strategy | None
    why: str = ""


@dataclass(frozen=True)
class Policy:
    """How the pool decides. A plug-in offers one under the entry point group `longarm.policies`.

    `choose` is given the options, fittest first, the situation, and the memory of what was tried. Without
    `heeds_fitness` the options include strategies that answer nothing likely.
    """

    name: str
    doc: str
    choose: Callable[[Sequence[Option], Situation, Memory], Decision]
    heeds_fitness: bool = True


def _first_fitted(options: Sequence[Option], situation: Situation, memory: Memory) -> Decision:
    best = options[0]
    for other in options[1:]:
        if other.strategy.name in best.strategy.opposes and other.fitness > AMBIGUITY * best.fitness:
            return Decision(None, f"{best.strategy.name} and {other.strategy.name} fit alike and conflict")
    return Decision(best.strategy)


def _fixed_order(options: Sequence[Option], situation: Situation, memory: Memory) -> Decision:
    return Decision(min((o.strategy for o in options), key=lambda s: (s.cost_s, s.name)))


def _round_robin(options: Sequence[Option], situation: Situation, memory: Memory) -> Decision:
    by_name = {o.strategy.name: o.strategy for o in options}
    later = [name for name in by_name if memory.last is not None and name > memory.last]
    return Decision(by_name[min(later or by_name)])


def _none(options: Sequence[Option], situation: Situation, memory: Memory) -> Decision:
    return Decision(None, "policy none leaves every failure to ground")


FIRST_FITTED = Policy(
    "first_fitted",
    "The fittest for what is likely and what failed, cost considered; none where the two fittest conflict.",
    _first_fitted,
)
FIXED_ORDER = Policy(
    "fixed_order",
    "The cheapest that may be tried here, whatever is likely: a peer to measure against.",
    _fixed_order,
    heeds_fitness=False,
)
ROUND_ROBIN = Policy(
    "round_robin",
    "By turns in the order of their names, whatever is likely: a peer to measure against.",
    _round_robin,
    heeds_fitness=False,
)
NONE = Policy("none", "No strategy: every failure is a call for help.", _none)
