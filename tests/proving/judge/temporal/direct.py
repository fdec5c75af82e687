"""The semantics word for word, without regard for time: for each sample and window, look at everything."""

import math

import numpy as np

from proving.judge.temporal.atoms import Atom
from proving.judge.temporal.formula import (
    Always,
    And,
    Eventually,
    Implies,
    Not,
    Or,
    Until,
)


def value(formula, trace, i):
    """Robustness at sample `i`; NaN if unknown."""
    match formula:
        case Atom():
            return float(formula.margins(trace.values, trace.count)[i])
        case Not(inner=inner):
            return -value(inner, trace, i)
        case And(left=left, right=right):
            return _all((value(left, trace, i), value(right, trace, i)))
        case Or(left=left, right=right):
            return -_all((-value(left, trace, i), -value(right, trace, i)))
        case Implies(left=left, right=right):
            return -_all((value(left, trace, i), -value(right, trace, i)))
        case Always(inner=inner, bounds=bounds):
            return _least([value(inner, trace, j) for j in _in_force(trace, i, bounds)])
        case Eventually(inner=inner, bounds=bounds):
            return -_least([-value(inner, trace, j) for j in _in_force(trace, i, bounds)])
        case Until(left=left, right=right, bounds=bounds):
            return _until(left, right, bounds, trace, i)
    raise TypeError(formula)


def _all(values):
    return math.nan if any(math.isnan(v) for v in values) else min(values)


def _least(values):
    known = [v for v in values if not math.isnan(v)]
    return min(known) if known else (math.nan if values else math.inf)


def _in_force(trace, i, bounds):
    """The samples in force at some moment of the window, up to the end of the trace."""
    opens = trace.times_ns[i] + bounds.first_ns
    closes = trace.end_ns if bounds.last_ns is None else trace.times_ns[i] + bounds.last_ns
    if opens > trace.end_ns:
        return []
    until_ns = [*trace.times_ns[1:], np.inf]
    return [j for j in range(trace.count) if trace.times_ns[j] <= closes and until_ns[j] > opens]


def _until(left, right, bounds, trace, i):
    window = _in_force(trace, i, bounds)
    lefts = [value(left, trace, j) for j in range(trace.count)]
    rights = [value(right, trace, j) for j in range(trace.count)]
    known = [not math.isnan(lefts[j]) and not math.isnan(rights[j]) for j in range(trace.count)]
    if window and not any(known[j] for j in window):
        return math.nan
    best = -math.inf
    for j in filter(known.__getitem__, window):
        # the moment: when the sample starts, or when the window opens while it is in force
        moment_ns = max(trace.times_ns[j], trace.times_ns[i] + bounds.first_ns)
        before = [lefts[k] for k in range(i, j + 1) if trace.times_ns[k] < moment_ns and known[k]]
        best = max(best, min([rights[j], *before]))
    return best
