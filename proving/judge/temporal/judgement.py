"""A formula held against a run: met or not, by how much, since when not, and whether that means anything."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from proving.judge.temporal.formula import Formula, atoms, names
from proving.judge.temporal.semantics import Decisions, Margins, evaluate
from proving.judge.temporal.trace import SignalTrace
from proving.judge.temporal.vacuity import warnings


@dataclass(frozen=True)
class Judgement:
    """`robustness` is in `unit` (SI): the margin of the one atom at the one time that decided.

    None where only flags decided, or nothing did. `violated_s` is the earliest time at which the formula was
    certain to fail, None if it holds. `warning` is a sentence, None if there is nothing to doubt.
    """

    met: bool
    robustness: float | None = None
    unit: str | None = None
    violated_s: float | None = None
    warning: str | None = None


def judge(formula: Formula, trace: SignalTrace) -> Judgement:
    """The judgement over a whole run. A formula of which nothing is known is not met, with a warning."""
    silent = [name for name in names(formula) if name in trace.silent]
    if silent:
        return Judgement(False, warning=f"no samples of {', '.join(silent)}")
    decisions = Decisions(trace)
    decision = float(evaluate(formula, trace, decisions)[0])
    if math.isnan(decision):
        return Judgement(False, warning=_unknown(formula, trace))
    met = decision > 0
    margin = float(evaluate(formula, trace, Margins(trace))[0])
    known = math.isfinite(margin)
    return Judgement(
        met,
        margin + 0.0 if known else None,  # not -0.0
        _unit(formula, trace, margin) if known else None,
        None if met else decisions.time_s(decision),
        "; ".join(warnings(formula, trace)) or None,
    )


def _unknown(formula: Formula, trace: SignalTrace) -> str:
    late = [name for name in names(formula) if np.isnan(trace.values[name][0])]
    if late:
        return (
            f"unknown at the start: {', '.join(late)} had no sample yet; put always or eventually before it"
        )
    return "unknown: its arithmetic has no result"


def _unit(formula: Formula, trace: SignalTrace, margin: float) -> str | None:
    """That of the atom which decided: minima and maxima choose, they never mix."""
    for atom in atoms(formula):
        if abs(margin) in np.abs(atom.margins(trace.values, trace.count)):
            return atom.unit
    return None
