"""From the marker plane to the rover: `plc` -> `body` through the cabin joints (executive.rig)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from executive.rig import CabinCalibration
from executive.types import Array
from perception.checks import as_finite
from perception.rotation import rot_y, rot_y_rate, skew


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
    arm_end = np.array(cabin.arm_pivot_body_m) + rot_y(-arm_rad) @ [cabin.arm_length_m, 0.0, 0.0]
    rotation = rot_y(-cabin_rad)
    return Transform(rotation, arm_end + rotation @ np.array(cabin.plc_offset_cabin_m))


def points_in_body(
    cabin: CabinCalibration, points_plc_m: Array, arm_rad: float, cabin_rad: float
) -> tuple[Array, Array]:
    """Points (n, 3) of `plc` in `body`, and their derivatives by (arm, cabin), shape (n, 3, 2)."""
    points = plc_in_body(cabin, arm_rad, cabin_rad).apply(points_plc_m)
    by_arm = -rot_y_rate(-arm_rad) @ [cabin.arm_length_m, 0.0, 0.0]
    by_cabin = -(points_plc_m + np.array(cabin.plc_offset_cabin_m)) @ rot_y_rate(-cabin_rad).T
    return points, np.stack([np.broadcast_to(by_arm, points.shape), by_cabin], axis=-1)


def body_from_plc(
    cabin: CabinCalibration, site_plc: Transform, covariance: Array, arm_rad: float, cabin_rad: float
) -> tuple[Transform, Array]:
    """Pose of `body` in `site` from that of `plc`, covariance (6, 6) in the order of PoseEstimate.

    Joint angles are known to `joint_sigma_rad` each; both add to the body's uncertainty.
    """
    P = as_finite("covariance", covariance, (6, 6))
    site_body = site_plc @ plc_in_body(cabin, arm_rad, cabin_rad).inverse()
    lever = site_body.position_m - site_plc.position_m
    carry = np.eye(6)
    carry[:3, 3:] = -skew(lever)
    G = carry @ _plc_motion_by_joints(cabin, site_body, arm_rad, cabin_rad)
    return site_body, carry @ P @ carry.T + cabin.joint_sigma_rad**2 * G @ G.T


def _plc_motion_by_joints(
    cabin: CabinCalibration, site_body: Transform, arm_rad: float, cabin_rad: float
) -> Array:
    """How the plc (position, rotation vector, in site) would move per joint angle, shape (6, 2)."""
    origin_rates = points_in_body(cabin, np.zeros((1, 3)), arm_rad, cabin_rad)[1][0]
    by_arm = np.concatenate([origin_rates[:, 0], [0.0, 0.0, 0.0]])
    by_cabin = np.concatenate([origin_rates[:, 1], [0.0, -1.0, 0.0]])
    G = np.stack([by_arm, by_cabin], axis=1)
    return np.concatenate([site_body.rotation @ G[:3], site_body.rotation @ G[3:]])
