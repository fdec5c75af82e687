"""Nothing is seen although the rover stands still: what hides it may pass by itself."""

from pathlib import Path

from executive.core.types import Reason
from executive.isc.hypotheses import Hypothesis
from executive.pool.pool import Strategy

STRATEGY = Strategy(
    name="wait_for_sight",
    doc="Wait at rest for the light, or the cameras, to recover, and measure again.",
    tree=Path(__file__).with_suffix(".yaml"),
    answers={Hypothesis.ILLUMINATION_CHANGE: 1.0, Hypothesis.MARKER_LOST: 0.2, Hypothesis.LOST_ROVER: 0.2},
    reasons={
        Reason.NOT_SEEN: 0.2,
        Reason.UNSTABLE_IMAGES: 0.4,
        Reason.IMPLAUSIBLE: 0.2,  # what misleads the cameras may pass too
        Reason.DEVICE: 0.2,
    },
    cost_s=1200.0,
)
