"""Rotation matrices of rotation vectors and back."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array
from perception.kernels.compiled import compiled


@compiled
def exp_map(vector_rad: Array) -> Array:
    """Rotation matrix of a rotation vector (Rodrigues); exact near zero too."""
    x, y, z = vector_rad[0], vector_rad[1], vector_rad[2]
    angle2 = x * x + y * y + z * z
    angle = math.sqrt(angle2)
    if angle < 1e-6:
        first, second = 1.0 - angle2 / 6, 0.5 - angle2 / 24
    else:
        first, second = math.sin(angle) / angle, (1 - math.cos(angle)) / angle2
    R = np.empty((3, 3))
    R[0, 0] = 1.0 - second * (y * y + z * z)
    R[1, 1] = 1.0 - second * (x * x + z * z)
    R[2, 2] = 1.0 - second * (x * x + y * y)
    R[0, 1], R[1, 0] = second * x * y - first * z, second * x * y + first * z
    R[0, 2], R[2, 0] = second * x * z + first * y, second * x * z - first * y
    R[1, 2], R[2, 1] = second * y * z - first * x, second * y * z + first * x
    return R


@compiled
def quaternion(m: Array) -> Array:
    """Unit quaternion (x, y, z, w), w >= 0, of a rotation matrix (Shepperd: pivots on the largest)."""
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    q, k, largest = np.empty(4), 3, trace
    for i in range(2, -1, -1):
        if m[i, i] >= largest:
            k, largest = i, m[i, i]
    if k == 3:
        q[0], q[1], q[2] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
        q[3] = 1.0 + trace
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        q[k] = 1.0 + 2.0 * m[k, k] - trace
        q[i], q[j] = m[i, k] + m[k, i], m[j, k] + m[k, j]
        q[3] = m[j, i] - m[i, j]
    length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return q * (math.copysign(1.0, q[3]) / length)


@compiled
def log_map(rotation: Array) -> Array:
    """Rotation vector of a rotation matrix, length in [0, pi]."""
    q = quaternion(rotation)
    sine = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    scale = 2.0 if sine < 1e-12 else 2.0 * math.atan2(sine, q[3]) / sine
    return scale * q[:3]


@compiled
def product(A: Array, B: Array) -> Array:
    """A @ B of 3 x 3 matrices."""
    out = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]
    return out


@compiled
def moved(rotation: Array, position_m: Array, step: Array) -> tuple[Array, Array]:
    """A pose changed by a step that begins with (position, rotation vector on the left)."""
    return product(exp_map(step[3:6]), rotation), position_m + step[:3]
