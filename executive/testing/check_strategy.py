"""What every strategy plug-in must keep."""

from __future__ import annotations

from executive.pool import Strategy
from executive.pool.kind import broken_promises


class StrategyBreach(AssertionError):
    """The strategy broke promises; the message says which."""


def check_strategy(strategy: Strategy) -> None:
    """Raise StrategyBreach with every promise not kept. The tree itself is checked where it is loaded."""
    if broken := tuple(broken_promises(strategy)):
        raise StrategyBreach(f"strategy {strategy.name}: {'; '.join(broken)}")
