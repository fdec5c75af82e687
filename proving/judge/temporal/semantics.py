"""What a formula is worth at every sample: one recursion of min, max and minus, over two kinds of numbers.

    margins    by how much each atom holds: the formula's robustness
    decisions  when each atom is known to hold or not, and which: its verdict, and when that was certain

An early "no" is less than a late one, and less than any "yes"; the later a "yes", the less it is. In that
order "and" is the least of its sides, "or" the greatest, and "not" turns it round, just as for margins.

A formula is unknown (NaN) where an atom in it is unknown; temporal operators leave unknown samples out.
A window beyond the end of the trace is empty: always is then true of it, eventually and until are not.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from executive.core.types import Array
from proving.judge.temporal.atoms import Atom
from proving.judge.temporal.formula import (
    Always,
    And,
    Bounds,
    Eventually,
    Formula,
    Implies,
    Not,
    Or,
    Until,
)
from proving.judge.temporal.trace import SignalTrace
from proving.judge.temporal.windows import least


class Scale(Protocol):
    """What numbers stand for true and false."""

    def of(self, atom: Atom) -> Array: ...

    def seen_out(self, values: Array, bounds: Bounds) -> Array:
        """Of an always: where it holds, its window must have passed before that is certain."""


class Margins:
    """Robustness: by how much, in the atoms' own units."""

    def __init__(self, trace: SignalTrace) -> None:
        self._trace = trace

    def of(self, atom: Atom) -> Array:
        return atom.margins(self._trace.values, self._trace.count)

    def seen_out(self, values: Array, bounds: Bounds) -> Array:
        return values


class Decisions:
    """Yes (positive) or no (negative), the larger the earlier: the time left to the end, plus one [ns]."""

    def __init__(self, trace: SignalTrace) -> None:
        self._trace = trace
        self._left = (trace.end_ns + 1 - trace.times_ns).astype(np.float64)

    def of(self, atom: Atom) -> Array:
        return atom.holds(self._trace.values, self._trace.count) * self._left

    def seen_out(self, values: Array, bounds: Bounds) -> Array:
        if bounds.last_ns is None:
            return np.where(values > 0, np.minimum(values, 1.0), values)
        return np.where(values > 0, np.minimum(values, np.maximum(self._left - bounds.last_ns, 1.0)), values)

    def time_s(self, decision: float) -> float:
        """When it was certain [s]."""
        return float((self._trace.end_ns + 1 - abs(decision)) / 1e9)


def evaluate(formula: Formula, trace: SignalTrace, scale: Scale) -> Array:
    """The formula's value at each sample, as if the mission began there; shape (n,)."""
    match formula:
        case Atom():
            return scale.of(formula)
        case Not(inner=inner):
            return -evaluate(inner, trace, scale)
        case And(left=left, right=right):
            return np.minimum(evaluate(left, trace, scale), evaluate(right, trace, scale))
        case Or(left=left, right=right):
            return np.maximum(evaluate(left, trace, scale), evaluate(right, trace, scale))
        case Implies(left=left, right=right):
            return np.maximum(-evaluate(left, trace, scale), evaluate(right, trace, scale))
        case Always(inner=inner, bounds=bounds):
            return _always(evaluate(inner, trace, scale), bounds, trace, scale)
        case Eventually(inner=inner, bounds=bounds):
            return -_always(-evaluate(inner, trace, scale), bounds, trace, scale)
        case Until(left=left, right=right, bounds=bounds):
            values = evaluate(left, trace, scale), evaluate(right, trace, scale)
            return _until(*values, bounds, trace, scale)


def _always(values: Array, bounds: Bounds, trace: SignalTrace, scale: Scale) -> Array:
    return scale.seen_out(least(values, *trace.window(bounds)), bounds)


def _until(left: Array, right: Array, bounds: Bounds, trace: SignalTrace, scale: Scale) -> Array:
    """In O(n log w), by taking it apart (Donzé, Ferrère and Maler 2013, lemma 7).

    A until[a, b] B  =  eventually[a, b] B, and A before a, and from a on (A until B) without bounds
    """
    unknown = np.isnan(left) | np.isnan(right)
    left, right = np.where(unknown, np.nan, left), np.where(unknown, np.nan, right)
    comes = -_always(-right, bounds, trace, scale)
    first, _ = trace.window(bounds)
    here = np.arange(trace.count)
    opens = np.minimum(first, trace.count - 1)
    inside = trace.times_ns[opens] < trace.times_ns + bounds.first_ns  # opens while that sample is in force
    before = least(left, here, np.where(inside, opens, opens - 1))
    later = _until_at_all(left, right)[opens]
    return np.minimum(comes, np.fmin(before, later))


def _until_at_all(left: Array, right: Array) -> Array:
    """A until B without bounds: backwards, B now, or A now and A until B from the next sample on."""
    found, coming = [], -math.inf
    for now, then in zip(reversed(left.tolist()), reversed(right.tolist()), strict=True):
        if not math.isnan(now):
            coming = max(then, min(now, coming))
        found.append(coming)
    return np.array(found[::-1])
