"""Lenses: points in the head's frame `ih` to pixels with their derivatives, and back."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from executive.core.types import Array
from perception.kernels.compiled import compiled
from perception.kernels.linear import factor, solve

_MIN_DEPTH_M = 1e-6
_UNDISTORT_STEPS = 12


class Optics(NamedTuple):
    """Cameras: rotation_cam_ih (c, 3, 3), position_ih_m (c, 3), focal_px (c,), principal_px (c, 2),
    distortion (c, 5) as (k1, k2, p1, p2, k3)."""

    rotation_cam_ih: Array
    position_ih_m: Array
    focal_px: Array
    principal_px: Array
    distortion: Array


@compiled
def distorted(x: float, y: float, k: Array) -> tuple[float, float, float, float, float]:
    """Brown-Conrady distortion of normalised coordinates: (x, y) and its symmetric Jacobian (xx, xy, yy)."""
    k1, k2, p1, p2, k3 = k[0], k[1], k[2], k[3], k[4]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3))  # d radial / d x = slope * x
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        radial + slope * x * x + 2 * p1 * y + 6 * p2 * x,
        slope * x * y + 2 * p1 * x + 2 * p2 * y,
        radial + slope * y * y + 6 * p1 * y + 2 * p2 * x,
    )


@compiled
def undistorted(x: float, y: float, k: Array) -> tuple[float, float]:
    """Inverse of `distorted` by Newton's method; exact to rounding for lenses that do not fold."""
    found_x, found_y = x, y
    if not k.any():
        return found_x, found_y
    for _ in range(_UNDISTORT_STEPS):
        got_x, got_y, xx, xy, yy = distorted(found_x, found_y, k)
        off_x, off_y, det = x - got_x, y - got_y, xx * yy - xy * xy
        found_x += (yy * off_x - xy * off_y) / det
        found_y += (xx * off_y - xy * off_x) / det
    return found_x, found_y


@compiled
def pixel(optics: Optics, c: int, point_ih_m: Array, J: Array) -> tuple[float, float]:
    """Pixel of a point (3,) in camera c, NaN unless in front of it; fills J (2, 3), by the point."""
    turn = optics.rotation_cam_ih[c]
    x = y = z = 0.0
    for i in range(3):
        from_eye = point_ih_m[i] - optics.position_ih_m[c, i]
        x += turn[0, i] * from_eye
        y += turn[1, i] * from_eye
        z += turn[2, i] * from_eye
    depth = z if z > _MIN_DEPTH_M else math.nan
    x, y = x / depth, y / depth
    bent_x, bent_y, xx, xy, yy = distorted(x, y, optics.distortion[c])
    scale = optics.focal_px[c] / depth
    for i in range(3):
        along_x, along_y = turn[0, i] - x * turn[2, i], turn[1, i] - y * turn[2, i]
        J[0, i] = scale * (xx * along_x + xy * along_y)
        J[1, i] = scale * (xy * along_x + yy * along_y)
    focal = optics.focal_px[c]
    return optics.principal_px[c, 0] + focal * bent_x, optics.principal_px[c, 1] + focal * bent_y


@compiled
def pixels(optics: Optics, points_ih_m: Array) -> tuple[Array, Array]:
    """Pixels (c, n, 2) of points (n, 3) in `ih`, and their derivative by the point (c, n, 2, 3)."""
    cameras, n = len(optics.focal_px), len(points_ih_m)
    uv, J = np.empty((cameras, n, 2)), np.empty((cameras, n, 2, 3))
    for c in range(cameras):
        for k in range(n):
            uv[c, k, 0], uv[c, k, 1] = pixel(optics, c, points_ih_m[k], J[c, k])
    return uv, J


@compiled
def rays(optics: Optics, uv_px: Array) -> Array:
    """Unit directions (c, n, 3) in `ih` of the lines of sight through pixels (c, n, 2)."""
    cameras, n = uv_px.shape[:2]
    out = np.empty((cameras, n, 3))
    for c in range(cameras):
        turn, focal, middle = optics.rotation_cam_ih[c], optics.focal_px[c], optics.principal_px[c]
        for k in range(n):
            bent_x, bent_y = (uv_px[c, k, 0] - middle[0]) / focal, (uv_px[c, k, 1] - middle[1]) / focal
            x, y = undistorted(bent_x, bent_y, optics.distortion[c])
            length = math.sqrt(x * x + y * y + 1)
            for i in range(3):
                out[c, k, i] = (turn[0, i] * x + turn[1, i] * y + turn[2, i]) / length
    return out


@compiled
def triangulated(optics: Optics, uv_px: Array) -> Array:
    """Points (n, 3) in `ih` with least squared distance to both lines of sight through pixels (2, n, 2).

    Solves sum (I - r r^T)(y - c) = 0; NaN where a pixel is NaN.
    """
    ray = rays(optics, uv_px)
    points, A, b = np.empty((uv_px.shape[1], 3)), np.empty((3, 3)), np.empty(3)
    for k in range(len(points)):
        A[:], b[:] = 0.0, 0.0
        for c in range(len(ray)):
            for i in range(3):
                for j in range(3):
                    P = (1.0 if i == j else 0.0) - ray[c, k, i] * ray[c, k, j]
                    A[i, j] += P
                    b[i] += P * optics.position_ih_m[c, j]
        factor(A)
        solve(A, b)
        points[k] = b
    return points
