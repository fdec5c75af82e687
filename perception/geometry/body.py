"""From the marker plane to the rover: `plc` -> `body` through the cabin joints (executive.core.rig)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from executive.core.rig import CabinCalibration
from executive.core.types import Array
from perception.geometry.rotation import rot_y
from perception.kernels.chain import CabinChain
from perception.kernels.chain import points_in_body as _points_in_body
from perception.kernels.compiled import plain


@dataclass(frozen=True, eq=False)
class Transform:
    """Pose of frame b in frame a: x_a = rotation @ x_b + position_m."""

    rotation: Array
    position_m: Array

    def __matmul__(self, other: Transform) -> Transform:
        return Transform(self.rotation @ other.rotation, self.rotation @ other.position_m + self.position_m)

    def inverse(self) -> Transform:
        return Transform(self.rotation.T, -self.rotation.T @ self.position_m)

    def apply(self, points_m: Array) -> Array:
        """Points (n, 3) of frame b in frame a."""
        moved: Array = points_m @ self.rotation.T + self.position_m
        return moved


def plc_in_body(cabin: CabinCalibration, arm_rad: float, cabin_rad: float) -> Transform:
    """T_body_plc as documented with `CabinCalibration`; its two rotations combine to Ry(-cabin)."""
    origin, _ = points_in_body(cabin, np.zeros((1, 3)), arm_rad, cabin_rad)
    return Transform(rot_y(-cabin_rad), origin[0])


def points_in_body(
    cabin: CabinCalibration, points_plc_m: Array, arm_rad: float, cabin_rad: float
) -> tuple[Array, Array]:
    """Points (n, 3) of `plc` in `body`, and their derivatives by (arm, cabin), shape (n, 3, 2)."""
    return _points_in_body(kernel_cabin(cabin), plain(points_plc_m), float(arm_rad), float(cabin_rad))


@lru_cache(maxsize=64)
def kernel_cabin(cabin: CabinCalibration) -> CabinChain:
    """What the kernels take of the cabin."""
    pivot, offset = plain(cabin.arm_pivot_body_m), plain(cabin.plc_offset_cabin_m)
    return CabinChain(pivot, float(cabin.arm_length_m), offset)
