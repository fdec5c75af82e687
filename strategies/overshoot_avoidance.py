"""The rover ran past the way-point, or slips lengthwise: shorter legs, and back up if it is behind."""

from pathlib import Path

from executive.core.types import Reason
from executive.pool import Strategy

STRATEGY = Strategy(
    name="overshoot_avoidance",
    doc="Adopt the advance seen, shorten the legs, and back up to before a target that was passed.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={"overshoot": 1.0, "slip_longitudinal": 0.8},
    reasons={Reason.OVERSHOOT: 0.6},
    cost_s=180.0,
    excursion_m=0.05,
    tries_per_segment=4,
)
