"""How well a strategy fits a situation, and what forbids it there."""

from __future__ import annotations

from executive.core.corridor import distance_m, room_m
from executive.core.errors import StrategyRaised
from executive.core.ordered_sum import ordered_sum
from executive.pool.memory import Memory
from executive.pool.situation import Situation
from executive.pool.strategy import Strategy

SIGMAS = 2.0  # of the place, to keep from the margin
LEAST_WEIGHT = 0.02  # a hypothesis below this is no reason to act
LEAST_FITNESS = 0.1  # below this a remedy is a shot in the dark; ground decides better


def relevance(strategy: Strategy, situation: Situation) -> float:
    """How well it answers what is likely and what failed."""
    weights = situation.assessment.weights
    likely = ((weights.get(h, 0.0), a) for h, a in strategy.answers.items())
    explained = ordered_sum(weight * answers for weight, answers in likely if weight >= LEAST_WEIGHT)
    return explained + strategy.reasons.get(situation.failure.reason, 0.0)


def worthwhile_s(situation: Situation) -> float:
    """The cost that halves a strategy's fitness: much remains to be driven, then little is worth it."""
    offset = situation.pose.on(situation.segment).track
    remaining_m = offset.remaining_m if offset else 1.0
    return 1200.0 / (1.0 + remaining_m)


def refusal(strategy: Strategy, situation: Situation, memory: Memory) -> str | None:
    """What forbids it here, whatever it is good for; None if nothing does."""
    return _no_room(strategy, situation) or _tried(strategy, situation, memory) or _needs(strategy, situation)


def _no_room(strategy: Strategy, situation: Situation) -> str | None:
    segment = situation.segment
    if segment is None:
        return None
    if distance_m(segment, situation.pose.x_m, situation.pose.y_m) >= segment.off_track_m:
        return "beyond the off-track margin any autonomous correction is forbidden"
    room, doubt = room_m(situation.pose, segment, SIGMAS), situation.doubt
    if doubt is not None:
        room = min(room, doubt.room_m(segment, SIGMAS))
        if strategy.excursion_m > 0.0 and (exceeded := doubt.exceeded(segment)):
            return exceeded
    if strategy.excursion_m > max(room, 0.0):  # to stay where it is a rover needs no room
        return f"may leave the margin: needs {strategy.excursion_m:.2f} m, has {room:.2f} m"
    return None


def _tried(strategy: Strategy, situation: Situation, memory: Memory) -> str | None:
    if memory.failed_here(strategy.name, situation):
        return "did not help here before"
    tries = memory.tries(strategy.name, situation.segment)
    return f"tried {tries} times on this segment" if tries >= strategy.tries_per_segment else None


def _needs(strategy: Strategy, situation: Situation) -> str | None:
    try:
        return strategy.needs(situation)
    except Exception as error:
        raise StrategyRaised(strategy.name, error) from error
