"""What a formula's verdict does not rest on: implications never put to the test, windows never entered.

Only the samples that the formula asks about count: of `always[0 s, 5 min] (A implies B)` the first five
minutes, of B those at which A holds.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from proving.judge.temporal.formula import (
    Always,
    Eventually,
    Formula,
    Implies,
    Until,
    parts,
)
from proving.judge.temporal.semantics import Decisions, evaluate
from proving.judge.temporal.trace import SignalTrace
from proving.judge.temporal.windows import covered

Mask = NDArray[np.bool_]


def warnings(formula: Formula, trace: SignalTrace) -> list[str]:
    """A sentence for each part that said nothing of this run."""
    start = np.arange(trace.count) == 0
    return list(dict.fromkeys(_idle(formula, start, trace)))


def _idle(formula: Formula, asked: Mask, trace: SignalTrace) -> Iterator[str]:
    if not asked.any():
        return  # whatever stands around it has said so
    match formula:
        case Implies(left=left, right=right):
            met = asked & _holds(left, trace)
            if not met.any():
                yield f"vacuous: '{left.text}' never held"
            yield from _idle(left, asked, trace)
            yield from _idle(right, met, trace)
        case Always(bounds=bounds) | Eventually(bounds=bounds):
            first, last = trace.window(bounds)
            if not (asked & (last >= first)).any():
                yield f"the run ended before the window of '{formula.text}' opened"
            yield from _idle(formula.inner, covered(asked, first, last), trace)
        case Until(left=left, right=right, bounds=bounds):
            first, last = trace.window(bounds)
            here = np.arange(trace.count)
            if not (asked & (last >= first)).any():
                yield f"the run ended before the window of '{formula.text}' opened"
            elif _holds(right, trace)[asked].all() and bounds.first_ns == 0:
                yield f"vacuous: '{right.text}' held from the first, '{left.text}' was never asked for"
            yield from _idle(left, covered(asked, here, last), trace)
            yield from _idle(right, covered(asked, first, last), trace)
        case _:
            for part in parts(formula):
                yield from _idle(part, asked, trace)


def _holds(formula: Formula, trace: SignalTrace) -> Mask:
    """Where it is known to hold."""
    return evaluate(formula, trace, Decisions(trace)) > 0
