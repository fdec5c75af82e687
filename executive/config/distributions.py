"""Distributions in files: `{uniform: [10 mm, 30 mm]}` where a value could stand, drawn when it is resolved.

    {uniform: [a, b]}   {log_uniform: [a, b]}   {normal: [mean, sigma]}   {integer: [a, b]}   {choice: [...]}

Quantities keep the unit of the first number; what is drawn reads back bit for bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from executive.config.source import Place, Source
from executive.config.validate import Problems, shown
from executive.core import units
from executive.core.units import UnitError

Draw = Callable[[float, float, np.random.Generator], float]


def _log_uniform(low: float, high: float, rng: np.random.Generator) -> float:
    if not 0 < low <= high:
        raise UnitError(f"got limits {low:g} and {high:g}, expected 0 < first <= second")
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _uniform(low: float, high: float, rng: np.random.Generator) -> float:
    if low > high:
        raise UnitError(f"got limits {low:g} and {high:g}, expected first <= second")
    return float(rng.uniform(low, high))


def _normal(mean: float, sigma: float, rng: np.random.Generator) -> float:
    if sigma < 0:
        raise UnitError(f"got a standard deviation of {sigma:g}, expected 0 or more")
    return float(rng.normal(mean, sigma))


NUMBERS: dict[str, Draw] = {"uniform": _uniform, "log_uniform": _log_uniform, "normal": _normal}
NAMES = (*NUMBERS, "integer", "choice")


def is_distribution(data: object) -> bool:
    """Whether a file's value is a distribution: a mapping with one key, which names one."""
    return isinstance(data, dict) and len(data) == 1 and next(iter(data)) in NAMES


def draw(data: dict[str, Any], rng: np.random.Generator) -> Any:
    """One value; UnitError says what is wrong with the distribution."""
    ((name, given),) = data.items()
    if not isinstance(given, list) or not given or (name != "choice" and len(given) != 2):
        raise UnitError(f"got {shown(given)}, expected {'a list' if name == 'choice' else 'two values'}")
    if name == "choice":
        return given[int(rng.integers(len(given)))]
    if name == "integer":
        low, high = given
        if not all(type(v) is int for v in given) or low > high:
            raise UnitError(f"got {shown(given)}, expected two whole numbers, the first not the larger")
        return int(rng.integers(low, high + 1))
    return _number(NUMBERS[name], given, rng)


def _number(how: Draw, given: list[Any], rng: np.random.Generator) -> Any:
    (low, unit), (high, other) = (_split(value) for value in given)
    if unit != other:
        if units.dimension(unit) != units.dimension(other):
            raise UnitError(f"got {shown(given)}, expected two values of one dimension")
        high = float(high * float(units.factor(other)[0]) / float(units.factor(unit)[0]))
    value = how(low, high, rng)
    return units.written(value, unit) if unit else value


def _split(value: object) -> tuple[float, str]:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value), ""
    if isinstance(value, str):
        return units.split(value)
    raise UnitError(f"got {shown(value)}, expected a number, with its unit if it has one")


def drawn(source: Source, place: Place, rng_of: Callable[[str], np.random.Generator]) -> Source:
    """The source with every distribution at or below `place` replaced by a value drawn for its place.

    `rng_of` is given the place's name, dots between its steps. ConfigError with every complaint.
    """
    problems = Problems()
    for where in list(_places(source, place)):
        try:
            value = draw(source.get(where), rng_of(".".join(map(str, where))))
        except UnitError as error:
            problems.add(source.at(where).problem(str(error)))
            continue
        source = source.graft(where, Source(value, _marks(source, where, value)))
    problems.check()
    return source


def _marks(source: Source, where: Place, value: object, inner: Place = ()) -> dict[Place, Any]:
    """Everything in a drawn value stands where its distribution stood."""
    marks = {inner: source.at(where)}
    steps = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for step, part in steps:
        marks |= _marks(source, where, part, (*inner, step))
    return marks


def _places(source: Source, place: Place) -> Iterator[Place]:
    if place not in source.values:
        return
    data = source.get(place)
    if is_distribution(data):
        yield place
        return
    steps = data if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else ()
    for step in steps:
        yield from _places(source, (*place, step))
