"""The soil turns the rover less, or more, than the motion model believed: believe the soil."""

from pathlib import Path

from executive.core.types import Reason
from executive.pool import Strategy

STRATEGY = Strategy(
    name="turning_slip_compensation",
    doc="Adopt the turning ratio last seen as this soil's own; the next turn is commanded with it.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={"slip_turning": 1.0, "track_asymmetry": 0.6},
    reasons={Reason.OFF_HEADING: 0.3},
    cost_s=60.0,
    excursion_m=0.03,  # what turns against something that was not seen may push the rover aside
    tries_per_segment=4,
)
