"""The values that flow, for plug-ins: `from executive.types import Reason`."""

from executive.core.types import (
    CabinReading,
    HeadReading,
    Localisation,
    Outcome,
    Point,
    PoseEstimate,
    PoseSource,
    Quality,
    Reason,
    Segment,
    TetherReading,
    TiltReading,
    TrackOffset,
    TrackReading,
)

__all__ = [
    "CabinReading",
    "HeadReading",
    "Localisation",
    "Outcome",
    "Point",
    "PoseEstimate",
    "PoseSource",
    "Quality",
    "Reason",
    "Segment",
    "TetherReading",
    "TiltReading",
    "TrackOffset",
    "TrackReading",
]
