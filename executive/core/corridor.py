"""The corridor of a segment: all that lies no farther from it than its off-track margin, beyond its ends too.

Its shape is a capsule. Whoever asks how far a rover has strayed asks here: guidance, the drive under way, the
pool, and the judge of safety.
"""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array, PoseEstimate, Segment


def distances_m(segment: Segment, x_m: Array, y_m: Array) -> Array:
    """How far points lie from a segment [m], 0 or more: aside of it, or past the nearer of its ends."""
    c, s = math.cos(segment.bearing_rad), math.sin(segment.bearing_rad)
    dx, dy = x_m - segment.start.x_m, y_m - segment.start.y_m
    along, cross = c * dx + s * dy, c * dy - s * dx
    past = along - np.clip(along, 0.0, segment.length_m)
    return np.asarray(np.hypot(past, cross), dtype=np.float64)


def distance_m(segment: Segment, x_m: float, y_m: float) -> float:
    """The same of one point."""
    return float(distances_m(segment, np.array(x_m), np.array(y_m)))


def apart_m(segment: Segment, x_m: float, y_m: float) -> tuple[float, float]:
    """The vector to a point from the nearest point of the segment [m], in `site`."""
    c, s = math.cos(segment.bearing_rad), math.sin(segment.bearing_rad)
    along = c * (x_m - segment.start.x_m) + s * (y_m - segment.start.y_m)
    along = min(max(along, 0.0), segment.length_m)
    return x_m - segment.start.x_m - c * along, y_m - segment.start.y_m - s * along


def farthest_m(pose: PoseEstimate, segment: Segment, sigmas: float) -> float:
    """How far from the segment the rover may be [m], so many standard deviations of its place allowed for.

    The farthest of the ellipse's ends: away from the segment, along it and across. Beside a segment that is
    the cross-track error and the deviation across. inf for a pose that is no number.
    """
    x, y = pose.x_m, pose.y_m
    if not (math.isfinite(x) and math.isfinite(y) and np.isfinite(pose.covariance[:2, :2]).all()):
        return math.inf
    apart = apart_m(segment, x, y)
    along = (math.cos(segment.bearing_rad), math.sin(segment.bearing_rad))
    length = math.hypot(*apart)
    axes = [along, (-along[1], along[0])]
    if length > 0.0:
        axes.append((apart[0] / length, apart[1] / length))
    reach = [(u, sigmas * sigma_m(pose, u)) for u in axes]
    ends = np.array([(x + sign * r * u[0], y + sign * r * u[1]) for u, r in reach for sign in (1.0, -1.0)])
    return float(distances_m(segment, ends[:, 0], ends[:, 1]).max())


def sigma_m(pose: PoseEstimate, direction: tuple[float, float]) -> float:
    """Standard deviation of the place along a unit vector of the plan [m]."""
    u = np.array(direction)
    return math.sqrt(max(float(u @ pose.covariance[:2, :2] @ u), 0.0))


def room_m(pose: PoseEstimate, segment: Segment, sigmas: float) -> float:
    """How far the rover may stray before it may be out of the corridor [m]; negative where it may be.

    -inf for a pose that is no number: it may be anywhere.
    """
    return segment.off_track_m - farthest_m(pose, segment, sigmas)
