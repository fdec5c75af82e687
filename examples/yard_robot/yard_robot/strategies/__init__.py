"""What the yard robot does when something goes wrong."""

from __future__ import annotations

from pathlib import Path

from longarm import Reason, Strategy

_HERE = Path(__file__).parent

ADOPT_SLIP = Strategy(
    name="adopt_slip",
    doc="The wheels spin: take the advance last seen as this ground's own, and drive shorter stages.",
    tree=_HERE / "adopt_slip.yaml",
    answers={
        "wheel_slip": 1.0,
        "slip_longitudinal": 0.9,
        "slip_turning": 0.9,
        "stuck_on_obstacle": 0.3,
    },
    reasons={Reason.UNEXPECTED: 0.2},
    cost_s=20.0,
    tries_per_segment=4,
)

SHOW_ANOTHER_FACE = Strategy(
    name="show_another_face",
    doc="The markers that the camera sees are hidden: turn on the spot until another face shows.",
    tree=_HERE / "show_another_face.yaml",
    answers={"marker_covered": 1.0, "poor_view": 0.8, "lost_rover": 0.5, "marker_lost": 0.5},
    reasons={Reason.NOT_SEEN: 0.4, Reason.POOR_VIEW: 0.4},
    cost_s=40.0,
    excursion_m=0.05,
    tries_per_segment=4,
)

WAIT_AND_LOOK = Strategy(
    name="wait_and_look",
    doc="Nothing is seen, by the dark or by something in between: wait at rest, and look again and again.",
    tree=_HERE / "wait_and_look.yaml",
    answers={
        "illumination_change": 1.0,
        "marker_covered": 0.6,
        "lost_rover": 0.3,
    },
    reasons={Reason.UNSTABLE_IMAGES: 0.5, Reason.NOT_SEEN: 0.2},
    cost_s=100.0,
    tries_per_segment=6,
)

BACK_UP = Strategy(
    name="back_up",
    doc="The robot ran past the way-point: back up to before it, and drive there in short stages.",
    tree=_HERE / "back_up.yaml",
    answers={"overshoot": 1.0},
    reasons={Reason.OVERSHOOT: 0.6},
    cost_s=30.0,
    excursion_m=0.1,
    tries_per_segment=4,
)

RECHARGE = Strategy(
    name="recharge",
    doc="The battery is low: wait at rest until the sun has charged it.",
    tree=_HERE / "recharge.yaml",
    answers={"battery_low": 1.0},
    reasons={Reason.DEVICE: 0.3},
    cost_s=200.0,
    tries_per_segment=3,
)
