"""What the yard robot does when something goes wrong."""

from __future__ import annotations

from pathlib import Path

from executive.core.types import Reason
from executive.isc.hypotheses import Hypothesis
from executive.pool.pool import Strategy

_HERE = Path(__file__).parent

ADOPT_SLIP = Strategy(
    name="adopt_slip",
    doc="The wheels spin: take the advance last seen as this ground's own, and drive shorter stages.",
    tree=_HERE / "adopt_slip.yaml",
    answers={
        Hypothesis.SLIP_LONGITUDINAL: 1.0,
        Hypothesis.SLIP_TURNING: 0.9,
        Hypothesis.STUCK_ON_OBSTACLE: 0.3,
    },
    reasons={Reason.UNEXPECTED: 0.2},
    cost_s=20.0,
    tries_per_segment=4,
)

SHOW_ANOTHER_FACE = Strategy(
    name="show_another_face",
    doc="The markers that the camera sees are hidden: turn on the spot until another face shows.",
    tree=_HERE / "show_another_face.yaml",
    answers={Hypothesis.LOST_ROVER: 1.0, Hypothesis.MARKER_LOST: 0.7, Hypothesis.POOR_VIEW: 0.8},
    reasons={Reason.NOT_SEEN: 0.4, Reason.POOR_VIEW: 0.4},
    cost_s=40.0,
    excursion_m=0.05,
    tries_per_segment=4,
)

WAIT_FOR_LIGHT = Strategy(
    name="wait_for_light",
    doc="The picture is dark: wait a little at rest, and look again.",
    tree=_HERE / "wait_for_light.yaml",
    answers={Hypothesis.ILLUMINATION_CHANGE: 1.0, Hypothesis.LOST_ROVER: 0.2},
    reasons={Reason.UNSTABLE_IMAGES: 0.5, Reason.NOT_SEEN: 0.1},
    cost_s=60.0,
    tries_per_segment=6,
)
