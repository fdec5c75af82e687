"""What a scenario names of its tree, checked to be there: nodes, values, strategies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set

from executive.config.source import Place, Source
from executive.config.validate import guess
from executive.core import registry
from executive.core.errors import Problem
from executive.pool.kind import STRATEGY_KIND
from executive.tree.addresses import matches
from executive.tree.spec import TreeSpec, walk
from executive.tree.strategies import usable_trees

Named = tuple[Place, str]
"""A name that a file gives, and where."""


def strange_nodes(source: Source, named: Iterable[Named], tree: TreeSpec) -> Iterator[Problem]:
    """Addresses that mean no node of the tree, nor of a strategy where it may be tried."""
    named = tuple(named)
    paths = tuple(_node_paths(tree)) if named else ()
    names = sorted({path.rsplit("/", 1)[-1] for path in paths})
    for place, address in named:
        if not any(matches(address, path) for path in paths):
            last = address.rsplit("/", 1)[-1]
            text = f'got the node "{address}", which the tree {tree.name} does not have'
            yield source.at(place).problem(text + ("" if last in names else guess(last, names)))


def strange_values(source: Source, named: Iterable[Named], tree: TreeSpec) -> Iterator[Problem]:
    """Names of no value of the tree, its sub-trees and the strategies."""
    named = tuple(named)
    known = _value_names(tree) if named else set()  # loading every strategy takes long
    return _strangers(source, named, known, f"the value {{}}, which the tree {tree.name} does not have")


def strange_strategies(source: Source, named: Iterable[Named]) -> Iterator[Problem]:
    """Names of no installed strategy."""
    return _strangers(source, named, set(registry.names(STRATEGY_KIND)), "the unknown strategy {}")


def _node_paths(tree: TreeSpec) -> Iterator[str]:
    """The paths that nodes have in a run."""
    strategies = usable_trees()
    inside = [f"{n}/{p.partition('/')[2]}" for n, each in strategies.items() for p, _ in walk(each)]
    for path, node in walk(tree):
        yield path
        if node.kind.recovers:
            yield from (f"{path}/{each}" for each in inside)


def _value_names(tree: TreeSpec) -> set[str]:
    """What the values of a tree and of all its sub-trees are called, and of every strategy's."""
    trees = (tree, *usable_trees().values())
    inner = (node.tree for each in trees for _, node in walk(each) if node.tree is not None)
    return {name for each in (*trees, *inner) for name in each.values}


def _strangers(source: Source, named: Iterable[Named], known: Set[str], got: str) -> Iterator[Problem]:
    for place, name in named:
        if name not in known:
            yield source.at(place).problem("got " + got.format(f'"{name}"') + guess(name, sorted(known)))
