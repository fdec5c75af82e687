"""What may be wrong with the yard robot, and the one channel that the others do not show it on."""

from __future__ import annotations

from longarm import Categorical, Channel, Comparison, Concern, Gaussian, Hypothesis, Measured, Reason

from yard_robot.battery import BatteryReading


def _charge(seen: Comparison) -> Measured[float] | None:
    reading = seen.readings.get("battery", BatteryReading)
    return None if reading is None else Measured(reading.charge)


CHARGE = Channel(
    "charge", "State of charge of the battery, 0 to 1.", "", Gaussian(0.65, 0.2), _charge, ("battery",)
)

BATTERY_LOW = Hypothesis(
    "battery_low",
    "The battery will not carry the robot to the end of its way.",
    {"charge": Gaussian(0.15, 0.08)},
    concerns=Concern.SIGHT,  # it says nothing of how the robot moved
    needs=("battery",),
)

WHEEL_SLIP = Hypothesis(
    "wheel_slip",
    "The wheels spin: they turn freely, and the robot lags behind.",
    {
        "advance_ratio": Gaussian(0.6, 0.2),
        "turn_ratio": Gaussian(0.6, 0.25),
        "current_ratio": Gaussian(0.6, 0.3),
    },
    prior=2.0,
    needs=("wheels",),
)

MARKER_COVERED = Hypothesis(
    "marker_covered",
    "Something hides the markers that the camera should see.",
    {"failure": Categorical(frozenset({Reason.NOT_SEEN}), 0.7, 0.01)},
    prior=3.0,
    concerns=Concern.SIGHT,
    needs=("pole_camera",),
)
