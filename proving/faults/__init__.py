"""Faults of ports, localizer, tree and pool: they wrap, so that they act on any backend, and on hardware."""

from proving.faults.cameras import CAMERA_DEAD, FROZEN_FRAME, LATE_FRAME, MISSING_FRAME, SWAPPED_CAMERAS
from proving.faults.estimation import INCLINOMETER_BIAS, POSE_NAN, POSE_OUTLIER, POSE_STALE
from proving.faults.head import HEAD_ENCODER_OFFSET
from proving.faults.link import (
    LINK_CORRUPT,
    LINK_DELAY,
    LINK_DROP,
    LINK_DUPLICATE,
    LINK_OUTAGE,
    REPLAYED_UPLINK,
)
from proving.faults.nodes import LATE_TICK, NODE_FORCED, NODE_HANGS, NODE_RAISES
from proving.faults.process import PROCESS_KILLED
from proving.faults.sensors import CALIBRATION_DRIFT, EXPOSURE_OFF, HOT_PIXELS
from proving.faults.strategies import STRATEGY_MISSING, STRATEGY_SLOW, STRATEGY_WRONG
from proving.faults.tracks import CURRENTS_GARBAGE, ENCODER_LOST_COUNTS, ENCODER_SCALE, ENCODER_STUCK
from proving.faults.values import VALUE_CORRUPTED

__all__ = [
    "CALIBRATION_DRIFT",
    "CAMERA_DEAD",
    "CURRENTS_GARBAGE",
    "ENCODER_LOST_COUNTS",
    "ENCODER_SCALE",
    "ENCODER_STUCK",
    "EXPOSURE_OFF",
    "FROZEN_FRAME",
    "HEAD_ENCODER_OFFSET",
    "HOT_PIXELS",
    "INCLINOMETER_BIAS",
    "LATE_FRAME",
    "LATE_TICK",
    "LINK_CORRUPT",
    "LINK_DELAY",
    "LINK_DROP",
    "LINK_DUPLICATE",
    "LINK_OUTAGE",
    "MISSING_FRAME",
    "NODE_FORCED",
    "NODE_HANGS",
    "NODE_RAISES",
    "POSE_NAN",
    "POSE_OUTLIER",
    "POSE_STALE",
    "PROCESS_KILLED",
    "REPLAYED_UPLINK",
    "STRATEGY_MISSING",
    "STRATEGY_SLOW",
    "STRATEGY_WRONG",
    "SWAPPED_CAMERAS",
    "VALUE_CORRUPTED",
]
