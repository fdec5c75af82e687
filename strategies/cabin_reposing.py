"""The markers do not show well: tilt and lift the cabin so that they do."""

import math
from pathlib import Path

from executive.core.types import Reason
from executive.isc.hypotheses import Hypothesis
from executive.pool.pool import Situation, Strategy


def _not_yet_tilted(situation: Situation) -> str | None:
    raised = situation.cabin is not None and situation.cabin.arm_rad > math.radians(15.0)
    return "the cabin is already raised towards the head" if raised else None


STRATEGY = Strategy(
    name="cabin_reposing",
    doc="Lift the cabin and tilt it so that the marker plane faces the head as squarely as it can.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={
        Hypothesis.POOR_VIEW: 1.0,
        Hypothesis.MARKER_LOST: 0.7,
        Hypothesis.LOST_ROVER: 0.5,
    },
    reasons={Reason.NOT_SEEN: 0.4, Reason.POOR_VIEW: 0.5, Reason.IMPLAUSIBLE: 0.2},
    cost_s=120.0,
    needs=_not_yet_tilted,
)
