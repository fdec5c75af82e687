"""The linear first guess (paper, eqs. 3-5): an affine map of the plane and the rotation nearest to it."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array
from perception.kernels.chain import CabinChain, HeadChain, head_turns, points_in_body
from perception.kernels.compiled import compiled
from perception.kernels.rotations import product

_LEAST_SPREAD_M = 1e-6  # of markers across the line that they are nearest to


@compiled
def plane_guess(points_m: Array, markers_m: Array) -> tuple[Array, Array, bool]:
    """Rotation and position of the plane z = 0 whose markers (n, 3) are seen at points (n, 3), and whether
    they span it.

    The map's two columns [a b] with a x b as third have the polar factor of [a b] and its normal for nearest
    rotation; that of [a b] is [a b] G^(-1/2), G its Gram matrix.
    """
    n = len(points_m)
    middle, origin = np.zeros(3), np.zeros(2)
    for k in range(n):
        middle += points_m[k] / n
        origin += markers_m[k, :2] / n
    across, xx, xy, yy = np.zeros((3, 2)), 0.0, 0.0, 0.0
    for k in range(n):
        x, y = markers_m[k, 0] - origin[0], markers_m[k, 1] - origin[1]
        xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
        for i in range(3):
            across[i, 0] += (points_m[k, i] - middle[i]) * x
            across[i, 1] += (points_m[k, i] - middle[i]) * y
    least = (xx + yy - math.hypot(xx - yy, 2 * xy)) / 2
    if not least > _LEAST_SPREAD_M * _LEAST_SPREAD_M:
        return np.zeros((3, 3)), middle, False
    a, b = _columns(across, yy, -xy, xx, xx * yy - xy * xy)
    aa, ab, bb = (a * a).sum(), (a * b).sum(), (b * b).sum()
    root = math.sqrt(max(aa * bb - ab * ab, 0.0))
    span = math.sqrt(aa + bb + 2 * root)
    across[:, 0], across[:, 1] = a, b
    x_axis, y_axis = _columns(across, bb + root, -ab, aa + root, root * span)
    rotation = np.empty((3, 3))
    rotation[:, 0], rotation[:, 1] = x_axis, y_axis
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rotation[i, 2] = x_axis[j] * y_axis[k] - x_axis[k] * y_axis[j]
    return rotation, middle - x_axis * origin[0] - y_axis * origin[1], True


@compiled
def body_guess(
    head: HeadChain, cabin: CabinChain, points_ih_m: Array, markers_plc_m: Array, angles_rad: Array
) -> tuple[Array, Array, bool]:
    """Rotation and position of the body in site, from the plane seen at points (n, 3) in `ih`; see above."""
    ih_plc, plane_ih_m, spanned = plane_guess(points_ih_m, markers_plc_m)
    site_ih, _, _ = head_turns(head, angles_rad[0], angles_rad[1])
    corners = np.zeros((4, 3))  # the plane's axes, and its origin
    for i in range(3):
        corners[i, i] = 1.0
    in_body, _ = points_in_body(cabin, corners, angles_rad[2], angles_rad[3])
    plc_body, origin_m = np.empty((3, 3)), in_body[3]
    for i in range(3):
        plc_body[i] = in_body[i] - origin_m
    rotation = product(product(site_ih, ih_plc), plc_body)
    position_m = np.empty(3)
    for i in range(3):
        position_m[i] = (site_ih[i] * plane_ih_m).sum() - (rotation[i] * origin_m).sum()
    position_m[2] += head.mast_height_m
    return rotation, position_m, spanned


@compiled
def _columns(M: Array, xx: float, xy: float, yy: float, over: float) -> tuple[Array, Array]:
    """The columns of M [[xx, xy], [xy, yy]] / over, M (3, 2)."""
    return (M[:, 0] * xx + M[:, 1] * xy) / over, (M[:, 0] * xy + M[:, 1] * yy) / over
