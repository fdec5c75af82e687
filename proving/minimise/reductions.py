"""Ways to make a case smaller, the most telling first: faults, path, world, then each fault by itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from executive.core.units import (
    DURATION,
    UnitError,
    quantity,
    split,
)
from executive.record import FaultStages
from executive.run import FaultSpec, load_fault
from proving.inject.entries import RESERVED
from proving.minimise.fewer import fewer
from proving.minimise.trier import Trier
from proving.scenario_data import Data, Keys, get, replaced, without

QUIET = ("roughness", "added_roughness", "rocks", "craters", "slope", "position_error", "pixel_sigma")
"""What makes a world eventful by its amount."""
NEUTRAL_ONE = ("factor", "efficiency", "scale", "advance")
"""Parts of names of parameters that change nothing at 1; all others are taken to change nothing at 0."""
HALVINGS = 4
SHORTEST_S = 1.0


def reduce_all(trier: Trier) -> None:
    """Go round all reductions until none makes the case smaller."""
    before: Data | None = None
    while trier.best != before:
        before = trier.best
        for reduction in (faults, waypoints, world, each_fault):
            reduction(trier)


def faults(trier: Trier) -> None:
    """Fewer faults."""
    _fewer(trier, ("faults",), "fault")


def waypoints(trier: Trier) -> None:
    """A shorter path."""
    _fewer(trier, ("mission", "waypoints"), "way-point", least=2)


def world(trier: Trier) -> None:
    """Nothing in the world that does not matter: defaults, empty lists, a quiet ground."""
    for part in ("rig", "world"):
        _defaults(trier, (part,))
    for keys, value in list(_leaves(trier.best.get("world", {}), ("world",))):
        if isinstance(value, list):
            _fewer(trier, keys, str(keys[-1]))
        elif keys[-1] in QUIET:
            trier.keeps(replaced(trier.best, keys, _zero(value)), f"no {keys[-1]}")


def each_fault(trier: Trier) -> None:
    """Simpler in its onset and its course, shorter, weaker."""
    for index in range(len(trier.best.get("faults", ()))):
        for simplify in (_onset, _course, _duration, _severity):
            simplify(trier, index)


def _onset(trier: Trier, index: int) -> None:
    for keys in (("from",), ("from", "held"), ("from", "edge"), ("from", "count")):
        _without(trier, ("faults", index, *keys), f"{_name(trier, index)} without {' '.join(keys)}")


def _course(trier: Trier, index: int) -> None:
    for key in ("profile", "cause"):
        _without(trier, ("faults", index, key), f"{_name(trier, index)} without {key}")


def _duration(trier: Trier, index: int) -> None:
    """Halve how long it lasts, beginning with what was left of the run."""
    if _spec(trier, index).lasting:
        return
    keys: Keys = ("faults", index, "for")
    lasts_s = _lasts_s(trier, index)
    for _ in range(HALVINGS):
        lasts_s = round(lasts_s / 2)
        shorter = replaced(trier.best, keys, f"{lasts_s} s")
        what = f"{_name(trier, index)} for {lasts_s} s"
        if lasts_s < SHORTEST_S or not trier.keeps(shorter, what):
            return


def _severity(trier: Trier, index: int) -> None:
    """Halve the distance of each quantity from where it would change nothing."""
    kind = _kind(trier.best["faults"][index])
    for parameter, value in list((trier.best["faults"][index][kind] or {}).items()):
        for weaker in _weaker(parameter, value):
            keys: Keys = ("faults", index, kind, parameter)
            what = f"{_name(trier, index)} with {parameter} {weaker}"
            if not trier.keeps(replaced(trier.best, keys, weaker), what):
                break


def _weaker(parameter: str, value: Any) -> Iterator[Any]:
    try:
        number, unit = split(value) if isinstance(value, str) else (value, "")
    except UnitError:
        return
    if isinstance(number, bool) or not isinstance(number, float):
        return
    neutral = 0.0
    if any(word in parameter for word in NEUTRAL_ONE):
        neutral = 100.0 if unit == "%" else 1.0
    for _ in range(HALVINGS):
        number = float(f"{(number + neutral) / 2:.3g}")
        yield f"{number:g} {unit}" if unit else number


def _fewer(trier: Trier, keys: Keys, noun: str, least: int = 0) -> None:
    items = get(trier.best, keys)
    if not isinstance(items, list):
        return

    def still(rest: list[Any]) -> bool:
        gone = len(get(trier.best, keys)) - len(rest)
        return trier.keeps(replaced(trier.best, keys, rest), f"{gone} {noun}{'s' if gone > 1 else ''} less")

    fewer(items, still, least)


def _defaults(trier: Trier, keys: Keys) -> None:
    """Leave out what is said here, all of it or, if that matters, part by part."""
    value = get(trier.best, keys)
    if value is None or _without(trier, keys, f"without {' '.join(map(str, keys))}"):
        return
    for key in list(value) if isinstance(value, dict) else ():
        _defaults(trier, (*keys, key))


def _without(trier: Trier, keys: Keys, what: str) -> bool:
    if get(trier.best, keys) is None:
        return False
    return trier.keeps(without(trier.best, keys), what)


def _leaves(data: Any, keys: Keys) -> Iterator[tuple[Keys, Any]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _leaves(value, (*keys, key))
    else:
        yield keys, data


def _zero(value: Any) -> Any:
    return f"0 {split(value)[1]}" if isinstance(value, str) else 0 if isinstance(value, int) else 0.0


def _kind(entry: Data) -> str:
    return next(key for key in entry if key not in RESERVED)


def _spec(trier: Trier, index: int) -> FaultSpec:
    return load_fault(_kind(trier.best["faults"][index]))


def _name(trier: Trier, index: int) -> str:
    entry = trier.best["faults"][index]
    return str(entry.get("name", _kind(entry)))


def _lasts_s(trier: Trier, index: int) -> float:
    """How long the fault was there: as its file says, else from its onset to the end of the run [s]."""
    given = trier.best["faults"][index].get("for")
    if given is not None:
        return quantity(given, DURATION)
    name = _name(trier, index)
    fault = next((each for each in trier.result.faults if each.name == name), FaultStages(name))
    return trier.result.mission_s - (fault.t_armed_s or 0.0)
