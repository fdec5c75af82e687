"""The pan-tilt unit: encoder readings to the pose of `ih` in `site` (executive.core.rig.HeadCalibration)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from executive.core.rig import HeadCalibration
from executive.core.types import Array, Vec2
from perception.geometry.body import Transform
from perception.geometry.rotation import rot_x, rot_y, rot_z
from perception.kernels.chain import HeadChain, head_turns


def site_ih(head: HeadCalibration, head_rad: Vec2) -> Transform:
    """Pose of the head in site at these encoder readings (pan, tilt)."""
    pan, tilt = head_rad
    rotation, _, _ = head_turns(kernel_head(head), float(pan), float(tilt))
    return Transform(rotation, np.array([0.0, 0.0, head.mast_height_m]))


def head_rates(head: HeadCalibration, head_rad: Vec2) -> tuple[Array, Array]:
    """Derivatives (3, 3) of the head's rotation in site by pan and by tilt."""
    pan, tilt = head_rad
    _, by_pan, by_tilt = head_turns(kernel_head(head), float(pan), float(tilt))
    return by_pan, by_tilt


def axes_site(head: HeadCalibration, head_rad: Vec2) -> tuple[Array, Array]:
    """The axes (3,) in site about which the head turns in pan and in tilt at these encoder readings."""
    fixed = kernel_head(head)
    before, between = fixed.before_pan, fixed.before_tilt
    return before[:, 2], (before @ rot_z(head_rad[0] + head.pan_zero_rad) @ between)[:, 1]


@lru_cache(maxsize=64)
def kernel_head(head: HeadCalibration) -> HeadChain:
    """What the kernels take of the head."""
    before, between = rot_y(head.lean_rad[1]) @ rot_x(head.lean_rad[0]), rot_x(head.axes_skew_rad)
    zeros = np.array([head.pan_zero_rad, head.tilt_zero_rad])
    return HeadChain(before, between, zeros, float(head.mast_height_m))
