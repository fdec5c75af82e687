"""Faults that act in the simulated world, by what they act on. PyBullet is imported only when one acts."""

from sim_pybullet.faults.cameras import HEAD_VIBRATION, IMAGE_BLUR
from sim_pybullet.faults.head import (
    HEAD_BACKLASH,
    HEAD_OFFSET,
    HEAD_SLOW,
    HEAD_STEP_LOSS,
    LANDER_SETTLING,
    PAN_LOCKED,
    TILT_LOCKED,
)
from sim_pybullet.faults.joints import ARM_LOCKED, CABIN_LOCKED
from sim_pybullet.faults.light import CLOUD, GLARE, SUN_MOVING
from sim_pybullet.faults.markers import (
    FALSE_REFLECTION,
    LED_DIM,
    LED_OFF,
    LED_STUCK_ON,
    LED_SWAPPED,
    MARKER_OCCLUDED,
)
from sim_pybullet.faults.rocks import CABIN_GROUNDING, MOVING_ROCK, ROCK_ON_PATH, WRONG_ELEVATION_MODEL
from sim_pybullet.faults.terrain import LOW_FRICTION_PATCH, SAND_TRAP, SIDE_SLOPE_DRIFT, SLIP_BURST
from sim_pybullet.faults.tether import SPOOL_JAM, TETHER_CAPSTAN, TETHER_SHORT, TETHER_SLACK, TETHER_SNAG
from sim_pybullet.faults.tracks import MOTOR_DEAD, MOTOR_REVERSED, MOTOR_RUNAWAY, TRACK_JAM, TRACK_WEAK

__all__ = [
    "ARM_LOCKED",
    "CABIN_GROUNDING",
    "CABIN_LOCKED",
    "CLOUD",
    "FALSE_REFLECTION",
    "GLARE",
    "HEAD_BACKLASH",
    "HEAD_OFFSET",
    "HEAD_SLOW",
    "HEAD_STEP_LOSS",
    "HEAD_VIBRATION",
    "IMAGE_BLUR",
    "LANDER_SETTLING",
    "LED_DIM",
    "LED_OFF",
    "LED_STUCK_ON",
    "LED_SWAPPED",
    "LOW_FRICTION_PATCH",
    "MARKER_OCCLUDED",
    "MOTOR_DEAD",
    "MOTOR_REVERSED",
    "MOTOR_RUNAWAY",
    "MOVING_ROCK",
    "PAN_LOCKED",
    "ROCK_ON_PATH",
    "SAND_TRAP",
    "SIDE_SLOPE_DRIFT",
    "SLIP_BURST",
    "SPOOL_JAM",
    "SUN_MOVING",
    "TETHER_CAPSTAN",
    "TETHER_SHORT",
    "TETHER_SLACK",
    "TETHER_SNAG",
    "TILT_LOCKED",
    "TRACK_JAM",
    "TRACK_WEAK",
    "WRONG_ELEVATION_MODEL",
]
