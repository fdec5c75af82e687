"""The rows of a judgement, as `result.json` has them, and which of them failed first."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

Row = dict[str, object]


def row(
    text: str,
    met: bool | None,
    robustness: float | None = None,
    unit: str | None = None,
    t_violation_s: float | None = None,
    warning: str | None = None,
) -> Row:
    """One row. `met` None where nothing is known; `robustness`, in `unit`, is negative where it is not met.

    `t_violation_s` is when it was certain not to be met [s], and is left out where it is met.
    """
    known = robustness is not None and math.isfinite(robustness)
    return {
        "text": text,
        "met": met,
        "robustness": robustness if known else None,
        "unit": unit if known else None,
        "t_violation_s": t_violation_s if met is False else None,
        "warning": warning,
    }


def first_violated(rows: Iterable[Mapping[str, object]]) -> Mapping[str, object] | None:
    """Of the rows not met the one that failed earliest, None where all are met."""
    return next(iter(worst_first(row for row in rows if row["met"] is False)), None)


def worst_first(rows: Iterable[Mapping[str, object]]) -> list[Mapping[str, object]]:
    """What is not met first, in the order in which it failed, then the rest."""
    return sorted(rows, key=lambda row: (row["met"] is not False, _time_s(row)))


def _time_s(row: Mapping[str, object]) -> float:
    time_s = row.get("t_violation_s")
    return time_s if isinstance(time_s, float | int) else math.inf
