"""Scenarios to start from when a hole is to be filled: what they reach, and when."""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from executive.core import registry
from executive.core.errors import ConfigError
from executive.pool import Strategy
from executive.record import History, events
from executive.run import FAULT_KIND, ResolvedScenario, load_fault
from proving.coverage.items import Item
from proving.coverage.recipes import Fault, at_node, for_item
from proving.coverage.universe import Universe
from proving.inject.entries import RESERVED
from proving.scenario_data import Data, resolved

DURATIONS: dict[str, tuple[str | None, ...]] = {"helped": ("5 min",), "failed": (None,)}
"""How long a fault that is to provoke a strategy's verdict lasts; None: for good."""
EITHER = ("5 min", None)
SOMEWHERE = {"progress": "25 %"}


@dataclass(frozen=True)
class Base:
    """A scenario that was run, and the nodes that were entered in it."""

    data: Data
    entered: frozenset[str]

    @classmethod
    def of(cls, data: Data, history: History, universe: Universe) -> Base:
        """Of a scenario and the record of its run."""
        paths = {change.path for _, change in history.all(events.NodeChange) if change.status != "invalid"}
        return cls(data, frozenset(universe.places[path] for path in paths if path in universe.places))

    def with_fault(self, fault: Fault, start: Data, lasts: str | None) -> Data:
        """The scenario with one more fault."""
        data = copy.deepcopy(self.data)
        (kind,) = fault
        taken = Counter(key for entry in data.get("faults", ()) for key in entry if key not in RESERVED)
        entry: Data = {**fault, "from": start}
        if taken[kind]:
            entry["name"] = f"{kind}_{taken[kind] + 1}"
        if lasts is not None and not _lasting(kind):
            entry["for"] = lasts
        data["faults"] = [*data.get("faults", ()), entry]
        return data


def candidates(hole: Item, bases: list[Base], strategies: dict[str, Strategy]) -> Iterator[Data]:
    """Scenarios that may fill a hole, the likeliest first; simple bases before those with many faults."""
    bases = sorted(bases, key=lambda base: len(base.data.get("faults", ())))
    for lasts in DURATIONS.get(hole.word, EITHER):
        if hole.kind != "node":
            for fault in for_item(hole, strategies):
                if _installed(fault):
                    yield bases[0].with_fault(fault, SOMEWHERE, lasts)
            continue
        reaching = [base for base in bases if hole.name in base.entered]
        for fault in at_node(hole.word, hole.name):
            for base in reaching[:2] if _installed(fault) else ():
                yield base.with_fault(fault, {"node": hole.name}, lasts)


def resolved_or_none(data: Data) -> ResolvedScenario | None:
    """What a candidate comes to, None where it cannot be run."""
    try:
        return resolved(data)
    except ConfigError:
        return None


def _installed(fault: Fault) -> bool:
    return next(iter(fault)) in registry.names(FAULT_KIND)


def _lasting(kind: str) -> bool:
    return load_fault(kind).lasting
