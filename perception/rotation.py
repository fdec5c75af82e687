"""Rotations: matrices, rotation vectors, quaternions (x, y, z, w). Angles in rad."""

from __future__ import annotations

import math

import numpy as np

from executive.types import Array, Quat


def rot_x(angle_rad: float) -> Array:
    """Rotation about x (y towards z for a positive angle)."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def rot_y(angle_rad: float) -> Array:
    """Rotation about y (x towards -z for a positive angle)."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rot_y_rate(angle_rad: float) -> Array:
    """d rot_y / d angle."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[-s, 0.0, c], [0.0, 0.0, 0.0], [-c, 0.0, -s]])


def rot_z(angle_rad: float) -> Array:
    """Rotation about z (x towards y for a positive angle)."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rot_z_rate(angle_rad: float) -> Array:
    """d rot_z / d angle."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[-s, -c, 0.0], [c, -s, 0.0], [0.0, 0.0, 0.0]])


def skew(vectors: Array) -> Array:
    """Cross-product matrices of (..., 3) vectors: skew(a) @ b = a x b. Shape (..., 3, 3)."""
    out = np.zeros((*vectors.shape, 3))
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -z, y, -x
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = z, -y, x
    return out


def exp_map(vector_rad: Array) -> Array:
    """Rotation matrix of a rotation vector (Rodrigues); exact near zero too."""
    angle = float(math.sqrt(vector_rad @ vector_rad))
    K = skew(vector_rad)
    if angle < 1e-6:
        first, second = 1.0 - angle**2 / 6, 0.5 - angle**2 / 24
    else:
        first, second = math.sin(angle) / angle, (1 - math.cos(angle)) / angle**2
    rotation: Array = np.eye(3) + first * K + second * (K @ K)
    return rotation


def log_map(rotation: Array) -> Array:
    """Rotation vector of a rotation matrix, length in [0, pi]."""
    x, y, z, w = quat_from_matrix(rotation)
    vector = np.array([x, y, z])
    sine = float(np.linalg.norm(vector))
    if sine < 1e-12:
        return 2.0 * vector
    result: Array = vector * (2.0 * math.atan2(sine, w) / sine)
    return result


def quat_from_matrix(rotation: Array) -> Quat:
    """Unit quaternion with w >= 0 of a rotation matrix (Shepperd: pivots on the largest component)."""
    m = rotation
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    squares = np.array([m[0, 0], m[1, 1], m[2, 2], trace])
    k = int(np.argmax(squares))
    if k == 3:
        q = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1.0 + trace])
    else:
        i, j, l = k, (k + 1) % 3, (k + 2) % 3  # noqa: E741 - cyclic indices
        q = np.empty(4)
        q[i] = 1.0 + 2.0 * m[i, i] - trace
        q[j] = m[j, i] + m[i, j]
        q[l] = m[l, i] + m[i, l]
        q[3] = m[l, j] - m[j, l]
    q *= math.copysign(1.0, q[3]) / np.linalg.norm(q)
    return float(q[0]), float(q[1]), float(q[2]), float(q[3])


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
