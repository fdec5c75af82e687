"""The strategies that are installed and can be used, with their trees."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from executive.config.registered import registered
from executive.config.source import Mark
from executive.core import registry
from executive.core.errors import ConfigError
from executive.core.registry import Broken
from executive.pool import Strategy
from executive.pool.kind import STRATEGY_KIND
from executive.tree.load import AS_IT_IS, Instead, load_tree
from executive.tree.spec import TreeSpec


def load_strategies() -> tuple[Strategy, ...]:
    """Every strategy that can be used, by name; the others are left out (`broken_strategies`)."""
    usable = registry.every(STRATEGY_KIND).values()
    return tuple(strategy for strategy in usable if not _problems(strategy))


def usable_trees() -> dict[str, TreeSpec]:
    """The own sub-tree of every strategy that can be used, by the strategy's name; each is loaded once."""
    trees: dict[str, TreeSpec] = {}
    for strategy in registry.every(STRATEGY_KIND).values():
        with suppress(ConfigError):  # `broken_strategies` tells
            trees[strategy.name] = load_tree(strategy.tree)
    return trees


def broken_strategies() -> tuple[Broken, ...]:
    """The strategies that the pool has to do without, and why."""
    bad = [(s, problems) for s in registry.every(STRATEGY_KIND).values() if (problems := _problems(s))]
    of_trees = (
        Broken(STRATEGY_KIND.name, s.name, registry.source_of(STRATEGY_KIND, s.name), problems)
        for s, problems in bad
    )
    return (*registry.broken(STRATEGY_KIND), *of_trees)


def usable_strategy(name: str, mark: Mark) -> Strategy:
    """The strategy of this name; ConfigError at `mark` where it is unknown, broken, or its tree is bad."""
    strategy = registered(STRATEGY_KIND, name, mark)
    if problems := _problems(strategy):
        source = registry.source_of(STRATEGY_KIND, name)
        raise ConfigError([mark.problem(str(Broken(STRATEGY_KIND.name, name, source, problems)))])
    return strategy


def strategy_trees(strategies: Sequence[Strategy], instead: Instead = AS_IT_IS) -> dict[str, TreeSpec]:
    """The strategies' own sub-trees by name; ConfigError with what is wrong in them.

    `instead` gives the texts of files that shall be taken to say something else.
    """
    return {strategy.name: load_tree(strategy.tree, instead=instead) for strategy in strategies}


def _problems(strategy: Strategy) -> str:
    """What is wrong with its tree, in one line."""
    try:
        load_tree(strategy.tree)
    except ConfigError as error:
        return "; ".join(str(problem) for problem in error.problems)
    return ""
