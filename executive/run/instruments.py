"""The instruments there are, in their order; and those of one run taken as one."""

from __future__ import annotations

from collections.abc import Sequence
from graphlib import TopologicalSorter
from typing import Any

from executive.core import registry
from executive.core.errors import PluginError
from executive.core.ports import Devices, Localizer
from executive.core.registry import Broken
from executive.pool import Strategy
from executive.run.instrument import INSTRUMENT_KIND, Instrument, InstrumentSpec, TreeParts


def instruments_there_are() -> tuple[InstrumentSpec[Any], ...]:
    """Every instrument that can be used, by name but for what comes `after` what.

    PluginError where two own the same key.
    """
    specs = registry.every(INSTRUMENT_KIND)
    before = {name: [other for other in spec.after if other in specs] for name, spec in specs.items()}
    owners: dict[str, str] = {}
    for key, name in ((key, name) for name, spec in specs.items() for key in spec.keys):
        if owners.setdefault(key, name) != name:
            raise PluginError(f'instrument {name}: the scenario key "{key}" belongs to {owners[key]} already')
    return tuple(specs[name] for name in TopologicalSorter(before).static_order())


def broken_instruments() -> tuple[Broken, ...]:
    """The instruments that runs have to do without, and why."""
    return tuple(each for each in registry.broken(INSTRUMENT_KIND) if each.name)


class Together(Instrument):
    """Several instruments as one; the first lies innermost."""

    def __init__(self, instruments: Sequence[Instrument]) -> None:
        self._instruments = instruments

    def wrap_devices(self, devices: Devices) -> Devices:
        for each in self._instruments:
            devices = each.wrap_devices(devices)
        return devices

    def wrap_localizer(self, localizer: Localizer) -> Localizer:
        for each in self._instruments:
            localizer = each.wrap_localizer(localizer)
        return localizer

    def wrap_pool(self, strategies: tuple[Strategy, ...]) -> tuple[Strategy, ...]:
        for each in self._instruments:
            strategies = each.wrap_pool(strategies)
        return strategies

    def wrap_tree(self, tree: TreeParts) -> None:
        for each in self._instruments:
            each.wrap_tree(tree)

    def hear(self, event: object) -> None:
        for each in self._instruments:
            each.hear(event)

    def tick(self, now_s: float) -> None:
        for each in self._instruments:
            each.tick(now_s)

    def conclude(self) -> str | None:
        """Every instrument is asked, whatever the others say."""
        said = [each.conclude() for each in self._instruments]
        return "; ".join(why for why in said if why) or None
