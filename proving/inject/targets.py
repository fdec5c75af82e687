"""What faults name of the tree, checked to be there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from executive.config.source import Source
from executive.core.errors import Problem
from executive.run import Named, strange_nodes, strange_strategies, strange_values
from executive.tree.spec import TreeSpec
from proving.inject.entries import ResolvedFault


def target_problems(source: Source, faults: Sequence[ResolvedFault], tree: TreeSpec) -> Iterator[Problem]:
    """Faults of a node, a value or a strategy that is not there: they could never come."""
    yield from strange_nodes(source, [*_onset_nodes(faults), *_parameters(faults, "node")], tree)
    yield from strange_values(source, _parameters(faults, "value"), tree)
    yield from strange_strategies(source, _parameters(faults, "strategy"))


def _onset_nodes(faults: Sequence[ResolvedFault]) -> Iterator[Named]:
    for i, fault in enumerate(faults):
        if fault.start.node is not None:
            yield ("faults", i, "from", "node"), fault.start.node


def _parameters(faults: Sequence[ResolvedFault], kind: str) -> Iterator[Named]:
    """The parameters of faults that name something of a tree."""
    for i, fault in enumerate(faults):
        parameter = getattr(fault.spec, kind)
        value = getattr(fault.parameters, parameter) if parameter else None
        if value is not None:
            yield ("faults", i, fault.spec.name, parameter), value
