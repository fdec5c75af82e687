"""Rotations: matrices, rotation vectors, quaternions (x, y, z, w). Angles in rad."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array, Quat
from perception.kernels import rotations
from perception.kernels.compiled import plain


def rot_x(angle_rad: float) -> Array:
    """Rotation about x (y towards z for a positive angle)."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def rot_y(angle_rad: float) -> Array:
    """Rotation about y (x towards -z for a positive angle)."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rot_z(angle_rad: float) -> Array:
    """Rotation about z (x towards y for a positive angle)."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def skew(vectors: Array) -> Array:
    """Cross-product matrices of (..., 3) vectors: skew(a) @ b = a x b. Shape (..., 3, 3)."""
    out = np.zeros((*vectors.shape, 3))
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -z, y, -x
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = z, -y, x
    return out


def exp_map(vector_rad: Array) -> Array:
    """Rotation matrix of a rotation vector (Rodrigues); exact near zero too."""
    return rotations.exp_map(plain(vector_rad))


def log_map(rotation: Array) -> Array:
    """Rotation vector of a rotation matrix, length in [0, pi]."""
    return rotations.log_map(plain(rotation))


def quat_from_matrix(rotation: Array) -> Quat:
    """Unit quaternion with w >= 0 of a rotation matrix."""
    x, y, z, w = rotations.quaternion(plain(rotation)).tolist()
    return x, y, z, w


def matrix_from_quat(quat: Quat) -> Array:
    """Rotation matrix of a quaternion (normalised first)."""
    x, y, z, w = np.asarray(quat) / np.linalg.norm(quat)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def nearest_rotation(matrix: Array) -> Array:
    """The rotation nearest to a 3x3 matrix in the Frobenius norm (SVD, determinant +1)."""
    U, _, Vt = np.linalg.svd(matrix)
    rotation: Array = U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))]) @ Vt
    return rotation
