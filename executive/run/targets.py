"""What a scenario names of its tree, checked to be there: nodes, values, strategies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set

from executive.config.expect import LISTS_OF_STEPS
from executive.config.source import Place, Source
from executive.config.validate import guess
from executive.core import registry
from executive.core.errors import Problem
from executive.inject.entries import ResolvedFault
from executive.pool.kind import STRATEGY_KIND
from executive.tree.addresses import means
from executive.tree.spec import TreeSpec, walk
from executive.tree.strategies import load_strategies, strategy_trees

Named = tuple[Place, str]


def target_problems(source: Source, faults: Sequence[ResolvedFault], tree: TreeSpec) -> list[Problem]:
    """Faults and expectations of a node, a value or a strategy that is not there: they could never come."""
    absent = f"{{}}, which the tree {tree.name} does not have"
    known = set(registry.names(STRATEGY_KIND))
    return [
        *_strange_nodes(source, [*_nodes_of(faults), *_steps(source)], tree),
        *_strangers(source, _parameters(faults, "value"), _value_names(tree), f"the value {absent}"),
        *_strangers(source, _parameters(faults, "strategy"), known, "the unknown strategy {}"),
    ]


def _nodes_of(faults: Sequence[ResolvedFault]) -> Iterator[Named]:
    for i, fault in enumerate(faults):
        if fault.start.node is not None:
            yield ("faults", i, "from", "node"), fault.start.node
    yield from _parameters(faults, "node")


def _parameters(faults: Sequence[ResolvedFault], kind: str) -> Iterator[Named]:
    """The parameters of faults that name something of a tree."""
    for i, fault in enumerate(faults):
        parameter = getattr(fault.spec, kind)
        value = getattr(fault.parameters, parameter) if parameter else None
        if value is not None:
            yield ("faults", i, fault.spec.name, parameter), value


def _steps(source: Source) -> Iterator[Named]:
    """The nodes that `expect` speaks of."""
    for key in LISTS_OF_STEPS:
        place: Place = ("expect", key)
        members = source.get(place) if place in source.values else None
        for index, member in enumerate(members if isinstance(members, list) else ()):
            at: Place = (*place, index)
            if isinstance(member, dict) and isinstance(member.get("of"), dict):
                at, member = (*at, "of"), member["of"]
            if isinstance(member, dict):
                yield from (((*at, name), str(name)) for name in member)


def _strange_nodes(source: Source, named: Sequence[Named], tree: TreeSpec) -> Iterator[Problem]:
    """Addresses that mean no node of the tree, nor of a strategy where it may be tried."""
    paths = tuple(_node_paths(tree)) if named else ()
    names = sorted({path.rsplit("/", 1)[-1] for path in paths})
    for place, address in named:
        if not any(means(address, path) for path in paths):
            last = address.rsplit("/", 1)[-1]
            text = f'got the node "{address}", which the tree {tree.name} does not have'
            yield source.at(place).problem(text + ("" if last in names else guess(last, names)))


def _node_paths(tree: TreeSpec) -> Iterator[str]:
    """The paths that nodes have in a run."""
    strategies = strategy_trees(load_strategies())
    inside = [f"{n}/{p.partition('/')[2]}" for n, each in strategies.items() for p, _ in walk(each)]
    for path, node in walk(tree):
        yield path
        if node.type == "recover":
            yield from (f"{path}/{each}" for each in inside)


def _value_names(tree: TreeSpec) -> set[str]:
    """What the values of a tree and of all its sub-trees are called, and of every strategy's."""
    trees = (tree, *strategy_trees(load_strategies()).values())
    inner = (node.tree for each in trees for _, node in walk(each) if node.tree is not None)
    return {name for each in (*trees, *inner) for name in each.values}


def _strangers(source: Source, named: Iterator[Named], known: Set[str], got: str) -> Iterator[Problem]:
    for place, name in named:
        if name not in known:
            yield source.at(place).problem("got " + got.format(f'"{name}"') + guess(name, sorted(known)))
