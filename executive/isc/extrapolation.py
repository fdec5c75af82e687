"""Where the present motion leads: the prediction run forward."""

from __future__ import annotations

import math

from executive.core.types import PoseEstimate, Segment
from executive.isc.attitude import wrap_rad


def time_to_margin_s(pose: PoseEstimate, segment: Segment, speed_m_s: float) -> float | None:
    """When a rover that goes straight on from `pose` crosses the off-track margin; None for never."""
    rate = speed_m_s * math.sin(wrap_rad(pose.heading_rad - segment.bearing_rad))
    cross = segment.offset(pose.x_m, pose.y_m).cross_m
    left = segment.off_track_m - cross if rate > 0 else segment.off_track_m + cross
    return None if abs(rate) < 1e-9 else max(left, 0.0) / abs(rate)
