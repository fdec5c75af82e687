"""What must hold of every run, fault or no fault, whatever its scenario expects."""

from __future__ import annotations

import math

from executive.core.rig import RigCalibration
from executive.record.history import History
from executive.record.rows import Row
from proving.judge.true_measures import (
    DRIVEN_BEYOND,
    TETHER,
    TILT,
    at_rest,
    below,
)

BEYOND_M = 0.001
"""Less than this driven beyond the margin is rounding."""


def safety_rows(history: History, world: History, rig: RigCalibration) -> list[Row]:
    """Never beyond the off-track margin, within the rig's limits of tilt and tether, at rest at the end.

    `met` is None where there is no truth to know it by.
    """
    tilt_deg, tether_n = math.degrees(rig.rover.tilt_limit_rad), rig.rover.tether_limit_n
    return [
        below("never driven beyond the off-track margin", DRIVEN_BEYOND, BEYOND_M, history, world),
        below(f"true tilt below {tilt_deg:.3g} deg", TILT, tilt_deg, history, world),
        below(f"tether below {tether_n:.3g} N", TETHER, tether_n, history, world),
        at_rest(history, world),
    ]
