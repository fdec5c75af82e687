"""Faults of the values that a tree hands from node to node."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Annotated, Any, Literal

from py_trees.behaviour import Behaviour
from pydantic import Field

from executive.core.units import Fraction
from executive.run import Cue, FaultSpec, TreeParts
from proving.faults.parameters import Parameters
from proving.faults.reticked import NodeFault, Reticked


class Corrupting(Parameters):
    """Which value becomes what."""

    value: Annotated[str, Field(min_length=1, description="name of the value, as the tree file has it")]
    kind: Annotated[
        Literal["nan", "none", "stale", "scaled"],
        Field(description="no number; unset; as it was at the onset; every number in it scaled"),
    ] = "nan"
    factor: Annotated[Fraction, Field(ge=-1000, le=1000, description="of scaled values")] = 1.5


class ValueCorrupted(NodeFault):
    """A value is wrong whenever a node is ticked, whoever has written it meanwhile."""

    def __init__(self, parameters: Corrupting) -> None:
        super().__init__("")
        self._parameters = parameters
        self._corrupt: dict[str, object] = {}
        self._kept: dict[str, object] = {}

    def wrap_tree(self, tree: TreeParts, cue: Cue) -> None:
        self._values = tree.values
        for path, node in tree.nodes.items():
            self.replace(Reticked(path, node), cue)

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        for key in [key for key in self._values if key.rpartition(":")[2] == self._parameters.value]:
            self._spoil(key)
        yield from node.run()

    def _spoil(self, key: str) -> None:
        value = self._values[key]
        if value is None or (key in self._corrupt and value is self._corrupt[key]):
            return
        spoilt = self._spoilt(key, value)
        self.altered += spoilt is not value
        self._values[key] = self._corrupt[key] = spoilt

    def _spoilt(self, key: str, value: object) -> object:
        match self._parameters.kind:
            case "none":
                return None
            case "stale":
                return self._kept.setdefault(key, value)
            case "nan":
                return each_number(value, lambda number: math.nan)
            case "scaled":
                return each_number(value, lambda number: number * self._parameters.factor)


def each_number(value: Any, change: Callable[[float], float]) -> Any:
    """The value with every float in it changed: in dataclasses and tuples of any depth, not in arrays."""
    if isinstance(value, float):
        return change(value)
    if isinstance(value, tuple):
        return tuple(each_number(part, change) for part in value)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: each_number(getattr(value, f.name), change) for f in fields(value)})
    return value


VALUE_CORRUPTED = FaultSpec(
    "value_corrupted",
    "A value that the tree hands from node to node is wrong: no number, unset, old or scaled.",
    Corrupting,
    ValueCorrupted,
    "",
    category="executive",
    value="value",
)
