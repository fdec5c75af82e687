"""The instrument that owns a scenario's `faults`: injects them, and says what never took effect."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from executive.config.source import Source
from executive.config.validate import Strict, parse
from executive.core.errors import Problem
from executive.run import Context, Instrument, InstrumentSpec, Schema, Setting
from executive.tree.spec import TreeSpec
from proving.inject import schema
from proving.inject.entries import ResolvedFault, fault_entries, ungrouped
from proving.inject.schedule import FaultSchedule
from proving.inject.targets import target_problems

Faults = tuple[ResolvedFault, ...]
KEY = "faults"


class FaultsKey(Strict):
    """A list of mappings; what they say is read entry by entry."""

    faults: tuple[dict[str, Any], ...] = ()


class FaultInjection(InstrumentSpec[Faults]):
    """Settings: the faults to be injected, in the order of the file."""

    name = KEY
    doc = "Injects the faults of a scenario, each with evidence that it took effect."
    keys = (KEY,)
    by_chance = (KEY,)

    def expand(self, source: Source) -> Source:
        return ungrouped(source, (KEY,))

    def read(self, source: Source, setting: Setting) -> Faults:
        parse(source, FaultsKey)
        return fault_entries(source, (KEY,), setting)

    def check(
        self, source: Source, settings: Mapping[str, object], tree: TreeSpec | None
    ) -> Iterable[Problem]:
        faults = settings.get(KEY)
        return target_problems(source, faults, tree) if isinstance(faults, tuple) and tree else ()

    def dump(self, settings: Faults) -> dict[str, object]:
        return {KEY: [fault.entry() for fault in settings]}

    def schema(self, defs: Schema) -> dict[str, Schema]:
        return {KEY: schema.faults(defs)}

    def make(self, settings: Faults, context: Context) -> Instrument:
        return FaultSchedule(settings, context)


INSTRUMENT = FaultInjection()
