"""The whole chain of projection: body pose, cabin joints and head angles to marker pixels, with Jacobian.

The state has ten parts: body pose in `site` (position, rotation vector on the left), pan, tilt, arm, cabin.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from executive.core.types import Array
from perception.kernels.compiled import compiled
from perception.kernels.optics import Optics, pixel
from perception.kernels.rotations import product

STATE_SIZE = 10


class HeadChain(NamedTuple):
    """The pan-tilt unit: rotations before the pan axis and between the axes (3, 3), zeros (2,) of pan and
    tilt, mast height."""

    before_pan: Array
    before_tilt: Array
    zeros_rad: Array
    mast_height_m: float


class CabinChain(NamedTuple):
    """The cabin: arm pivot (3,) in the body, arm length, plate (3,) in the cabin's axes [m]."""

    arm_pivot_body_m: Array
    arm_length_m: float
    plc_offset_cabin_m: Array


@compiled
def head_turns(head: HeadChain, pan_rad: float, tilt_rad: float) -> tuple[Array, Array, Array]:
    """Rotation (3, 3) of `ih` in `site` at these encoder readings, and its derivatives by pan and tilt."""
    pan, tilt = pan_rad + head.zeros_rad[0], tilt_rad + head.zeros_rad[1]
    cp, sp, ct, st = math.cos(pan), math.sin(pan), math.cos(tilt), math.sin(tilt)
    about_z = np.array([[cp, -sp, 0.0], [sp, cp, 0.0], [0.0, 0.0, 1.0]])
    about_y = np.array([[ct, 0.0, st], [0.0, 1.0, 0.0], [-st, 0.0, ct]])
    z_rate = np.array([[-sp, -cp, 0.0], [cp, -sp, 0.0], [0.0, 0.0, 0.0]])
    y_rate = np.array([[-st, 0.0, ct], [0.0, 0.0, 0.0], [-ct, 0.0, -st]])
    panned = product(product(head.before_pan, about_z), head.before_tilt)
    panning = product(product(head.before_pan, z_rate), head.before_tilt)
    return product(panned, about_y), product(panning, about_y), product(panned, y_rate)


@compiled
def points_in_body(
    cabin: CabinChain, points_plc_m: Array, arm_rad: float, cabin_rad: float
) -> tuple[Array, Array]:
    """Points (n, 3) of `plc` in `body`, and their derivatives by (arm, cabin), (n, 3, 2)."""
    points, by_joints = np.empty((len(points_plc_m), 3)), np.zeros((len(points_plc_m), 3, 2))
    ca, sa, cc, sc = math.cos(arm_rad), math.sin(arm_rad), math.cos(cabin_rad), math.sin(cabin_rad)
    pivot, length, offset = cabin.arm_pivot_body_m, cabin.arm_length_m, cabin.plc_offset_cabin_m
    for k in range(len(points)):
        x, z = points_plc_m[k, 0] + offset[0], points_plc_m[k, 2] + offset[2]
        points[k, 0] = pivot[0] + length * ca + cc * x - sc * z
        points[k, 1] = pivot[1] + points_plc_m[k, 1] + offset[1]
        points[k, 2] = pivot[2] + length * sa + sc * x + cc * z
        by_joints[k, 0, 0], by_joints[k, 2, 0] = -length * sa, length * ca
        by_joints[k, 0, 1], by_joints[k, 2, 1] = -sc * x - cc * z, cc * x - sc * z
    return points, by_joints


@compiled
def project_points(
    optics: Optics,
    head: HeadChain,
    points_site_m: Array,
    pan_rad: float,
    tilt_rad: float,
    arms_site_m: Array,
    by_joints: Array,
) -> tuple[Array, Array]:
    """Pixels (c, n, 2) and Jacobian (c, n, 2, 10) of points (n, 3) in site, at arms (n, 3) from the body.

    `by_joints` (n, 3, 2) is how the points move in site by arm and cabin.
    """
    cameras, n = len(optics.focal_px), len(points_site_m)
    uv, J = np.empty((cameras, n, 2)), np.empty((cameras, n, 2, STATE_SIZE))
    turn, by_pan, by_tilt = head_turns(head, pan_rad, tilt_rad)
    in_head, by_state, by_point = np.empty(3), np.empty((3, STATE_SIZE)), np.empty((2, 3))
    for k in range(n):
        x, y, z = points_site_m[k, 0], points_site_m[k, 1], points_site_m[k, 2] - head.mast_height_m
        arm = arms_site_m[k]
        for i in range(3):
            a, b, c = turn[0, i], turn[1, i], turn[2, i]
            in_head[i] = a * x + b * y + c * z
            by_state[i, 0], by_state[i, 1], by_state[i, 2] = a, b, c
            by_state[i, 3] = c * arm[1] - b * arm[2]
            by_state[i, 4] = a * arm[2] - c * arm[0]
            by_state[i, 5] = b * arm[0] - a * arm[1]
            by_state[i, 6] = by_pan[0, i] * x + by_pan[1, i] * y + by_pan[2, i] * z
            by_state[i, 7] = by_tilt[0, i] * x + by_tilt[1, i] * y + by_tilt[2, i] * z
            for j in range(2):
                by_state[i, 8 + j] = a * by_joints[k, 0, j] + b * by_joints[k, 1, j] + c * by_joints[k, 2, j]
        for camera in range(cameras):
            uv[camera, k, 0], uv[camera, k, 1] = pixel(optics, camera, in_head, by_point)
            for row in range(2):
                for s in range(STATE_SIZE):
                    J[camera, k, row, s] = (
                        by_point[row, 0] * by_state[0, s]
                        + by_point[row, 1] * by_state[1, s]
                        + by_point[row, 2] * by_state[2, s]
                    )
    return uv, J


@compiled
def project(
    optics: Optics,
    head: HeadChain,
    cabin: CabinChain,
    markers_plc_m: Array,
    rotation: Array,
    position_m: Array,
    angles_rad: Array,
) -> tuple[Array, Array]:
    """Pixels (c, n, 2) and Jacobian (c, n, 2, 10) of markers (n, 3) on a body at this pose in site.

    `angles_rad` (4,) are (pan, tilt, arm, cabin).
    """
    in_body, by_joints = points_in_body(cabin, markers_plc_m, angles_rad[2], angles_rad[3])
    points, arms, moves = np.empty_like(in_body), np.empty_like(in_body), np.empty_like(by_joints)
    for k in range(len(in_body)):
        for i in range(3):
            a, b, c = rotation[i, 0], rotation[i, 1], rotation[i, 2]
            arms[k, i] = a * in_body[k, 0] + b * in_body[k, 1] + c * in_body[k, 2]
            points[k, i] = position_m[i] + arms[k, i]
            for j in range(2):
                moves[k, i, j] = a * by_joints[k, 0, j] + b * by_joints[k, 1, j] + c * by_joints[k, 2, j]
    return project_points(optics, head, points, angles_rad[0], angles_rad[1], arms, moves)
