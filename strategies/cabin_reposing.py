"""The markers do not show well: tilt and lift the cabin so that they do."""

import math
from pathlib import Path

from executive.core.types import CabinReading, Reason
from executive.pool import Situation, Strategy


def _not_yet_tilted(situation: Situation) -> str | None:
    cabin = situation.readings.get("cabin", CabinReading)
    raised = cabin is not None and cabin.arm_rad > math.radians(15.0)
    return "the cabin is already raised towards the head" if raised else None


STRATEGY = Strategy(
    name="cabin_reposing",
    doc="Lift the cabin and tilt it so that the marker plane faces the head as squarely as it can.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={
        "poor_view": 1.0,
        "marker_lost": 0.7,
        "lost_rover": 0.5,
    },
    reasons={Reason.NOT_SEEN: 0.4, Reason.POOR_VIEW: 0.5, Reason.IMPLAUSIBLE: 0.2},
    cost_s=120.0,
    needs=_not_yet_tilted,
)
