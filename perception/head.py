"""The pan-tilt unit: encoder readings to the pose of `ih` in `site` (executive.rig.HeadCalibration)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from executive.rig import HeadCalibration
from executive.types import Array, Vec2
from perception.body import Transform
from perception.rotation import rot_x, rot_y, rot_y_rate, rot_z, rot_z_rate


def site_ih(head: HeadCalibration, head_rad: Vec2) -> Transform:
    """Pose of the head in site at these encoder readings (pan, tilt)."""
    before, between = _fixed(head)
    pan, tilt = head_rad[0] + head.pan_zero_rad, head_rad[1] + head.tilt_zero_rad
    return Transform(before @ rot_z(pan) @ between @ rot_y(tilt), np.array([0.0, 0.0, head.mast_height_m]))


def head_rates(head: HeadCalibration, head_rad: Vec2) -> tuple[Array, Array]:
    """Derivatives (3, 3) of the head's rotation in site by pan and by tilt."""
    before, between = _fixed(head)
    pan, tilt = head_rad[0] + head.pan_zero_rad, head_rad[1] + head.tilt_zero_rad
    by_pan: Array = before @ rot_z_rate(pan) @ between @ rot_y(tilt)
    by_tilt: Array = before @ rot_z(pan) @ between @ rot_y_rate(tilt)
    return by_pan, by_tilt


def axes_site(head: HeadCalibration, head_rad: Vec2) -> tuple[Array, Array]:
    """The axes (3,) in site about which the head turns in pan and in tilt at these encoder readings."""
    before, between = _fixed(head)
    return before[:, 2], (before @ rot_z(head_rad[0] + head.pan_zero_rad) @ between)[:, 1]


@lru_cache(maxsize=64)
def _fixed(head: HeadCalibration) -> tuple[Array, Array]:
    """What stands before the pan axis and between the two axes."""
    return rot_y(head.lean_rad[1]) @ rot_x(head.lean_rad[0]), rot_x(head.axes_skew_rad)
