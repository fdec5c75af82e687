"""What every strategy plug-in must keep."""

from __future__ import annotations

from executive.core.types import Reason
from executive.isc.hypotheses import Hypothesis
from executive.pool.pool import Strategy


class StrategyBreach(AssertionError):
    """The strategy broke a promise; the message says which."""


def check_strategy(strategy: Strategy) -> None:
    """Raise StrategyBreach at the first promise not kept. The tree itself is checked where it is loaded."""
    _expect(strategy.name.isidentifier(), f"the name is an identifier, got {strategy.name!r}")
    _expect(bool(strategy.doc.strip()), "it says what it does")
    _expect(strategy.tree.is_file(), f"its tree exists: {strategy.tree}")
    _expect(bool(strategy.answers) or bool(strategy.reasons), "it answers something")
    answered_fits: list[tuple[object, float]] = [*strategy.answers.items(), *strategy.reasons.items()]
    for answered, fit in answered_fits:
        _expect(isinstance(answered, Hypothesis | Reason), f"{answered!r} is a hypothesis or a reason")
        _expect(0.0 < fit <= 1.0, f"fitness for {answered} lies in (0, 1], got {fit}")
    _expect(Hypothesis.NOMINAL not in strategy.answers, "nothing is to be done about nominal behaviour")
    _expect(strategy.cost_s > 0.0, f"it costs time, got {strategy.cost_s} s")
    _expect(strategy.excursion_m >= 0.0, f"its excursion is a distance, got {strategy.excursion_m} m")
    _expect(strategy.tries_per_segment > 0, "it may be tried at least once")


def _expect(held: bool, promise: str) -> None:
    if not held:
        raise StrategyBreach(promise)
