"""The strategies that are installed, with their trees."""

from __future__ import annotations

from collections.abc import Sequence

from executive.core import plugins
from executive.core.errors import PluginError
from executive.pool import Strategy
from executive.pool.kind import broken_promises
from executive.tree.load import AS_IT_IS, Instead, load_tree
from executive.tree.spec import TreeSpec


def load_strategies() -> tuple[Strategy, ...]:
    """Every strategy registered, by name; PluginError for one that does not keep what a strategy must."""
    loaded = []
    for name in plugins.found(plugins.STRATEGIES):
        strategy = plugins.load(plugins.STRATEGIES, name, Strategy)
        if broken := tuple(broken_promises(strategy)):
            raise PluginError(f"strategy {name}: {'; '.join(broken)}")
        loaded.append(strategy)
    return tuple(loaded)


def strategy_trees(strategies: Sequence[Strategy], instead: Instead = AS_IT_IS) -> dict[str, TreeSpec]:
    """The strategies' own sub-trees by name; ConfigError with what is wrong in them.

    `instead` gives the texts of files that shall be taken to say something else.
    """
    return {strategy.name: load_tree(strategy.tree, instead=instead) for strategy in strategies}
