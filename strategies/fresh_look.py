"""Fix and prediction contradict each other: inflate the prediction, and measure again."""

from pathlib import Path

from executive.core.types import Reason
from executive.pool import Strategy

STRATEGY = Strategy(
    name="fresh_look",
    doc="Widen the prediction and measure afresh: a false fix is not repeated, an unnoticed move is.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={"localisation_outlier": 1.0, "lost_rover": 0.2},
    reasons={Reason.IMPLAUSIBLE: 0.5},
    cost_s=90.0,
    excursion_m=0.03,  # what it finds may be that something pushes the rover aside
    tries_per_segment=4,
)
