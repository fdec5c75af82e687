"""All that this package adds to the executive, by kind."""

from yard_robot.backend import BACKEND
from yard_robot.devices import BATTERY, POLE_CAMERA, POWER, WHEELS
from yard_robot.diagnosis import BATTERY_LOW, CHARGE, MARKER_COVERED, WHEEL_SLIP
from yard_robot.faults import BATTERY_DRAIN, CAMERA_DARK, COVERED, SLIPPING
from yard_robot.localizer import YARD_MARKERS
from yard_robot.nodes import CheckBattery, RechargeWait
from yard_robot.strategies import ADOPT_SLIP, BACK_UP, RECHARGE, SHOW_ANOTHER_FACE, WAIT_AND_LOOK
from yard_robot.while_charged import WhileCharged

__all__ = [
    "ADOPT_SLIP",
    "BACKEND",
    "BACK_UP",
    "BATTERY",
    "BATTERY_DRAIN",
    "BATTERY_LOW",
    "CAMERA_DARK",
    "CHARGE",
    "COVERED",
    "MARKER_COVERED",
    "POLE_CAMERA",
    "POWER",
    "RECHARGE",
    "SHOW_ANOTHER_FACE",
    "SLIPPING",
    "WAIT_AND_LOOK",
    "WHEELS",
    "WHEEL_SLIP",
    "YARD_MARKERS",
    "CheckBattery",
    "RechargeWait",
    "WhileCharged",
]
