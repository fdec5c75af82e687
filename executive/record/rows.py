"""The rows of a judgement, as `result.json` has them, and which of them failed first."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class JudgedRow:
    """What was judged, in words, and how it came out: an expectation, or what must hold of every run.

    `met` None where nothing is known; `robustness`, in `unit`, is negative where it is not met.
    `t_violation_s` is when it was certain not to be met [s].
    """

    text: str
    met: bool | None
    robustness: float | None = None
    unit: str | None = None
    t_violation_s: float | None = None
    warning: str | None = None


def row(
    text: str,
    met: bool | None,
    robustness: float | None = None,
    unit: str | None = None,
    t_violation_s: float | None = None,
    warning: str | None = None,
) -> JudgedRow:
    """One row: a robustness that is not finite is left out, and so is `t_violation_s` where it is met."""
    known = robustness is not None and math.isfinite(robustness)
    return JudgedRow(
        text,
        met,
        robustness if known else None,
        unit if known else None,
        t_violation_s if met is False else None,
        warning,
    )


def first_violated(rows: Iterable[JudgedRow]) -> JudgedRow | None:
    """Of the rows not met the one that failed earliest, None where all are met."""
    return next(iter(worst_first(row for row in rows if row.met is False)), None)


def worst_first(rows: Iterable[JudgedRow]) -> list[JudgedRow]:
    """What is not met first, in the order in which it failed, then the rest."""
    return sorted(rows, key=lambda row: (row.met is not False, _time_s(row)))


def _time_s(row: JudgedRow) -> float:
    return math.inf if row.t_violation_s is None else row.t_violation_s
