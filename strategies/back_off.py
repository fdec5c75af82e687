"""Something holds the rover: back off, and come again a little to the side."""

from pathlib import Path

from executive.core.types import Reason
from executive.pool import Strategy

STRATEGY = Strategy(
    name="back_off",
    doc="Back off by 0.2 m, pass beside the path, and let the trek find its line again.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={"stuck_on_obstacle": 1.0, "tilt_risk": 0.7, "slip_longitudinal": 0.3},
    reasons={Reason.BLOCKED: 0.5, Reason.TILT: 0.4},
    cost_s=900.0,
    excursion_m=0.195,
    tries_per_segment=3,
)
