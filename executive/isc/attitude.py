"""Angles and attitudes."""

from __future__ import annotations

import math

from executive.core.types import Quat


def wrap_rad(angle_rad: float) -> float:
    """The same angle within (-pi, pi]."""
    return math.pi - (math.pi - angle_rad) % (2 * math.pi)


def quat_from_heading_tilt(heading_rad: float, roll_rad: float, pitch_rad: float) -> Quat:
    """Quaternion (x, y, z, w) of R = Rz(heading) Ry(pitch) Rx(roll)."""
    ch, sh = math.cos(heading_rad / 2), math.sin(heading_rad / 2)
    cp, sp = math.cos(pitch_rad / 2), math.sin(pitch_rad / 2)
    cr, sr = math.cos(roll_rad / 2), math.sin(roll_rad / 2)
    return (
        sr * cp * ch - cr * sp * sh,
        cr * sp * ch + sr * cp * sh,
        cr * cp * sh - sr * sp * ch,
        cr * cp * ch + sr * sp * sh,
    )
