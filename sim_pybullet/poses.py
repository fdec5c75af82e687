"""Transforms down the cabin's chain, exactly as rig.CabinCalibration documents it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.rig import CabinCalibration
from executive.core.types import Array, Vec3


@dataclass(frozen=True, eq=False)
class CabinChain:
    """T_site_body, T_site_arm, T_site_cabin, T_site_plc, 4x4, read-only; and the angles they follow from."""

    body: Array
    arm: Array
    cabin: Array
    plc: Array
    arm_rad: float
    cabin_rad: float


def transform(rotation: Array, translation_m: Array | Vec3) -> Array:
    """A 4x4 transform from a rotation (3, 3) and a translation (3,)."""
    result = np.eye(4)
    result[:3, :3] = rotation
    result[:3, 3] = translation_m
    return result


def about_y(angle_rad: float) -> Array:
    """Ry: takes z towards x."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def cabin_chain(
    calibration: CabinCalibration,
    position_site_m: Array,
    rotation_site_body: Array,
    arm_rad: float,
    cabin_rad: float,
) -> CabinChain:
    """The frames of the chain for these joint angles."""
    level = np.eye(3)
    body = transform(rotation_site_body, position_site_m)
    arm = body @ transform(about_y(-arm_rad), calibration.arm_pivot_body_m)
    cabin = arm @ transform(about_y(arm_rad - cabin_rad), (calibration.arm_length_m, 0.0, 0.0))
    plc = cabin @ transform(level, calibration.plc_offset_cabin_m)
    for matrix in (body, arm, cabin, plc):
        matrix.setflags(write=False)
    return CabinChain(body, arm, cabin, plc, arm_rad, cabin_rad)
