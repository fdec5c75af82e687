"""What every strategy must keep."""

from __future__ import annotations

from executive.core.errors import Breach, ConfigError
from executive.pool import Strategy
from executive.pool.kind import broken_promises
from executive.tree.load import load_tree


class StrategyBreach(Breach):
    """The strategy breaks promises; the message says which."""


def check_strategy(strategy: Strategy) -> None:
    """Raise StrategyBreach with every promise not kept, and with all that is wrong in its tree."""
    broken = list(broken_promises(strategy))
    if strategy.tree.is_file():
        try:
            load_tree(strategy.tree)
        except ConfigError as error:
            broken += [str(problem) for problem in error.problems]
    if broken:
        raise StrategyBreach(f"strategy {strategy.name}", broken)
