"""The values that flow, for plug-ins: `from executive.types import Reason`."""

from executive.core.types import (
    CabinReading,
    HeadReading,
    Outcome,
    Point,
    PoseEstimate,
    Quality,
    Reason,
    Segment,
    Source,
    TetherReading,
    TiltReading,
    TrackOffset,
    TrackReading,
)

__all__ = [
    "CabinReading",
    "HeadReading",
    "Outcome",
    "Point",
    "PoseEstimate",
    "Quality",
    "Reason",
    "Segment",
    "Source",
    "TetherReading",
    "TiltReading",
    "TrackOffset",
    "TrackReading",
]
