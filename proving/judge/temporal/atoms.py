"""The atoms of formulas: comparisons of signals, with a margin, and flags, which have none.

Both are worked out for all samples at once. A sample at which a signal has no value yet, or at which the
arithmetic has no result, is NaN: unknown.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from executive.core.units import si_unit
from executive.core.values import ValueType
from executive.tree.expressions.typed import (
    Expression,
    GuardError,
    Kind,
    Token,
    comparison,
    kind_text,
)

Values = Mapping[str, Array]
"""Every signal by name, all sampled at the same times, shape (n,)."""


@dataclass(frozen=True)
class Atom:
    """Something true or false of each sample. `unit` is the SI unit of its margins, None for a flag."""

    text: str
    names: tuple[str, ...]
    unit: str | None = field(compare=False)
    _margins: Callable[[Values], Any] = field(compare=False)
    _holds: Callable[[Values], Any] = field(compare=False)

    def margins(self, values: Values, count: int) -> Array:
        """By how much it holds (negative: fails), shape (count,); infinite for a flag, NaN if unknown."""
        return _spread(self._margins, values, count)

    def holds(self, values: Values, count: int) -> Array:
        """1 where it holds, -1 where it does not, NaN if unknown; shape (count,)."""
        known = ~np.isnan(self.margins(values, count))
        return np.where(known, np.where(_spread(self._holds, values, count) > 0, 1.0, -1.0), np.nan)


def atom(
    text: str, terms: Sequence[Expression], signs: Sequence[Token], types: Mapping[str, ValueType[Any]]
) -> Atom:
    """From a chain of comparisons, or a single flag; GuardError where it is neither, or dimensions clash."""
    whole = comparison(list(terms), list(signs)) if signs else terms[0]
    if (kind := whole.kind(types)) != "flag":
        raise GuardError(whole.offset, f"got {kind_text(kind)}, expected something true or false")
    names = tuple(dict.fromkeys(name for _, name, _ in whole.references))
    kinds = [term.kind(types) for term in terms]
    unit = si_unit(kinds[0]) if not isinstance(kinds[0], str) else None
    if not signs:
        return Atom(text, names, None, lambda values: _flag(terms[0], values), lambda v: _flag(terms[0], v))
    links = list(zip(signs, pairwise(terms), kinds, strict=False))

    def margins(values: Values) -> Any:
        return _least([_margin(sign, *_both(pair, values), kind) for sign, pair, kind in links])

    def holds(values: Values) -> Any:
        return _least(
            [np.where(_SHARP[sign.text](*_both(pair, values)), 1.0, -1.0) for sign, pair, _ in links]
        )

    return Atom(text, names, unit, margins, holds)


_SHARP: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def _margin(sign: Token, left: Any, right: Any, kind: Kind) -> Any:
    if isinstance(kind, str):
        return np.where(_SHARP[sign.text](left, right), np.inf, -np.inf)
    match sign.text[0]:
        case "<":
            found = right - left
        case ">":
            found = left - right
        case "=":
            found = -abs(left - right)
        case _:
            found = abs(left - right)
    return np.where(np.isfinite(found), found, np.nan)


def _both(pair: tuple[Expression, Expression], values: Values) -> tuple[Any, Any]:
    left, right = pair
    return left.evaluate(lambda name, _: values[name]), right.evaluate(lambda name, _: values[name])


def _flag(term: Expression, values: Values) -> Any:
    """A flag is wholly so or wholly not: its margin is infinite, so that others decide by how much."""
    value = np.asarray(term.evaluate(lambda name, _: values[name]), dtype=np.float64)
    return np.where(np.isnan(value), np.nan, np.where(value > 0.5, np.inf, -np.inf))


def _least(links: list[NDArray[np.float64]]) -> Any:
    return np.minimum.reduce(np.broadcast_arrays(*links))


def _spread(compute: Callable[[Values], Any], values: Values, count: int) -> Array:
    """One value per sample, also of what is the same at all of them."""
    try:
        with np.errstate(all="ignore"):
            found = compute(values)
    except (ZeroDivisionError, OverflowError):  # of constants
        found = np.nan
    return np.array(np.broadcast_to(np.asarray(found, dtype=np.float64), (count,)))
