"""What must hold of every run, fault or no fault, whatever its scenario expects."""

from __future__ import annotations

import math

from executive.core.rig import Rig
from executive.record import History, JudgedRow
from proving.judge.true_measures import (
    DRIVEN_BEYOND,
    TETHER,
    TILT,
    at_rest,
    below,
)

BEYOND_M = 0.001
"""Less than this driven beyond the margin is rounding."""


def safety_rows(history: History, world: History, rig: Rig) -> list[JudgedRow]:
    """Never beyond the off-track margin, within the rig's limits of tilt and tether, at rest at the end.

    `met` is None where there is no truth to know it by.
    """
    tilt_deg, tether_n = math.degrees(rig.rover.tilt_limit_rad), rig.rover.tether_limit_n
    rows = [
        below("never driven beyond the off-track margin", DRIVEN_BEYOND, BEYOND_M, history, world),
        below(f"true tilt below {tilt_deg:.3g} deg", TILT, tilt_deg, history, world),
    ]
    if tether_n is not None:
        rows.append(below(f"tether below {tether_n:.3g} N", TETHER, tether_n, history, world))
    return [*rows, at_rest(history, world)]
