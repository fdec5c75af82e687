"""Automatic follow-up: where the head looks so that a point is in the stereoscopic middle (paper, 4.3)."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array, Vec2
from perception.geometry.chain import Chain
from perception.geometry.checks import as_finite

_STEPS = 6
_PROBE_RAD = 1e-5


def pointing_at(chain: Chain, point_site_m: Array) -> Vec2:
    """Pan and tilt [rad] at which the point lies at opposite columns and rows of both cameras.

    Clipped to the head's limits. A point on the mast's axis has no pan: 0 is taken.
    """
    point = as_finite("point_site_m", point_site_m, (3,))
    x, y, z = point - [0.0, 0.0, chain.rig.head.mast_height_m]
    level = math.hypot(x, y)
    angles = np.array([math.atan2(y, x) if level > 1e-9 else 0.0, math.atan2(-z, level)])
    for _ in range(_STEPS):
        off = _off_middle(chain, point, angles)
        if not np.isfinite(off).all() or np.abs(off).max() < 1e-6:
            break
        angles = angles - np.linalg.solve(_slope(chain, point, angles), off)
    return _within_limits(chain, angles)


def _off_middle(chain: Chain, point: Array, angles: Array) -> Array:
    """Mean column and row of both cameras relative to their principal points [px], zero in the middle."""
    head = chain.site_ih((float(angles[0]), float(angles[1])))
    uv = chain.model.project(head.inverse().apply(point[None]))[:, 0]
    middle: Array = (uv - chain.model.principal_px).mean(axis=0)
    return middle


def _slope(chain: Chain, point: Array, angles: Array) -> Array:
    columns = []
    for step in np.eye(2) * _PROBE_RAD:
        rise = _off_middle(chain, point, angles + step) - _off_middle(chain, point, angles - step)
        columns.append(rise / (2 * _PROBE_RAD))
    return np.stack(columns, axis=1)


def _within_limits(chain: Chain, angles: Array) -> Vec2:
    head = chain.rig.head
    pan = math.remainder(float(angles[0]), 2 * math.pi)
    low, high = head.tilt_limits_rad
    return (
        min(max(pan, -head.pan_limit_rad), head.pan_limit_rad),
        min(max(float(angles[1]), low), high),
    )


def in_overlap(chain: Chain, head_rad: Vec2, points_site_m: Array, margin_px: float = 0.0) -> bool:
    """Whether both cameras see all points (n, 3), each `margin_px` from the edges of its frame."""
    points = as_finite("points_site_m", points_site_m, (None, 3))
    uv = chain.model.project(chain.site_ih(head_rad).inverse().apply(points))
    return bool(chain.model.inside(uv, margin_px).all())


def off_middle_rad(chain: Chain, head_rad: Vec2, point_site_m: Array) -> float:
    """How far the head would have to turn to bring the point to the stereoscopic middle [rad]."""
    pan, tilt = pointing_at(chain, point_site_m)
    return max(abs(math.remainder(pan - head_rad[0], 2 * math.pi)), abs(tilt - head_rad[1]))
