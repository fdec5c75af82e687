"""Nothing is seen although the rover stands still: what hides it may pass by itself."""

from pathlib import Path

from executive.core.types import Reason
from executive.pool import Strategy

STRATEGY = Strategy(
    name="wait_for_sight",
    doc="Wait at rest for the light, or the cameras, to recover, and measure again.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={"illumination_change": 1.0, "marker_lost": 0.2, "lost_rover": 0.2},
    reasons={
        Reason.NOT_SEEN: 0.2,
        Reason.UNSTABLE_IMAGES: 0.4,
        Reason.IMPLAUSIBLE: 0.2,  # what misleads the cameras may pass too
        Reason.DEVICE: 0.2,
    },
    cost_s=1200.0,
)
