"""A scenario as plain data: places in it changed or left out, what it comes to, and its text."""

from __future__ import annotations

import copy
from typing import Any

import yaml

from executive.config.source import read_text
from executive.core.errors import ConfigError
from executive.run import ResolvedScenario
from executive.run.resolve import resolve_source

Data = dict[str, Any]
Keys = tuple[str | int, ...]
NEEDED = ("scenario", "mission", "faults", "waypoints")
"""What a file cannot do without."""


def get(data: Any, keys: Keys) -> Any:
    """What stands at a place, None if nothing does."""
    for key in keys:
        if isinstance(data, dict):
            data = data.get(key)
        elif isinstance(data, list) and isinstance(key, int) and key < len(data):
            data = data[key]
        else:
            return None
    return data


def replaced(data: Data, keys: Keys, value: Any) -> Data:
    """A copy with this value at a place."""
    changed = copy.deepcopy(data)
    get(changed, keys[:-1])[keys[-1]] = value
    return changed


def without(data: Data, keys: Keys) -> Data:
    """A copy without what stands at a place."""
    changed = copy.deepcopy(data)
    del get(changed, keys[:-1])[keys[-1]]
    return changed


def stripped(data: Data) -> Data:
    """The same scenario without what goes without saying."""
    meant = resolved(data).dump()

    def visit(data: Data, keys: Keys) -> Data:
        shorter = without(data, keys)
        try:
            if resolved(shorter).dump() == meant:
                return shorter
        except ConfigError:
            pass  # it cannot be left out
        value = get(data, keys)
        for key in list(value) if isinstance(value, dict) else ():
            data = visit(data, (*keys, key))
        return data

    places: list[Keys] = [(key,) for key in data if key not in NEEDED]
    places += [("mission", key) for key in data["mission"] if key not in NEEDED]
    for index, entry in enumerate(data.get("faults", ())):
        places += [("faults", index, key) for key in entry if key != "for"]
    for place in places:
        data = visit(data, place)
    return data


def resolved(data: Data) -> ResolvedScenario:
    """The scenario that data stand for; ConfigError with every problem."""
    return resolve_source(read_text(written(data), "case.yaml"))


def read_back(scenario: ResolvedScenario) -> Data:
    """The data of a resolved scenario."""
    data: Data = yaml.safe_load(scenario.dump())
    return data


class _Dumper(yaml.SafeDumper):
    """Small mappings stand on their line, as people write scenarios."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def written(data: Data) -> str:
    """A scenario's data as YAML."""
    shape: Data = {"sort_keys": False, "default_flow_style": None, "width": 110, "allow_unicode": True}
    return str(yaml.dump(data, Dumper=_Dumper, **shape))
