"""The stereo camera model: frames `ih` -> `cam_left`/`cam_right` -> pixels (paper, eq. 2), and back."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from executive.rig import CameraCalibration, RigCalibration
from executive.types import Array
from perception.checks import as_array
from perception.rotation import rot_x, rot_y, rot_z

# Columns: camera x (right), y (down), z (forward) in ih axes (x forward, y left, z up).
_IH_CAM_UNTURNED = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])

_UNDISTORT_STEPS = 12
_MIN_DEPTH_M = 1e-6


@dataclass(frozen=True, eq=False)
class StereoModel:
    """Both cameras as stacked arrays: first axis 0 = left, 1 = right.

    rotation_cam_ih (2, 3, 3), position_ih_m (2, 3), focal_px (2,), principal_px (2, 2),
    distortion (2, 5) as (k1, k2, p1, p2, k3), size_px (2, 2) as (width, height).
    """

    rotation_cam_ih: Array
    position_ih_m: Array
    focal_px: Array
    principal_px: Array
    distortion: Array
    size_px: Array

    @classmethod
    def of(cls, rig: RigCalibration) -> StereoModel:
        cams: tuple[CameraCalibration, CameraCalibration] = rig.cameras
        return cls(
            rotation_cam_ih=np.stack([_rotation_ih_cam(c).T for c in cams]),
            position_ih_m=np.array([c.position_ih_m for c in cams]),
            focal_px=np.array([c.focal_px for c in cams]),
            principal_px=np.array([c.principal_px for c in cams]),
            distortion=np.array([c.distortion for c in cams]),
            size_px=np.array([(c.width_px, c.height_px) for c in cams], dtype=float),
        )

    def project(self, points_ih_m: Array) -> Array:
        """Pixels (2, n, 2) of points (n, 3) in `ih`; NaN for points not in front of a camera."""
        normal, _ = self._normalised(as_array("points_ih_m", points_ih_m, (None, 3)))
        bent = distort(normal, self.distortion[:, None, :])[0] if self.distortion.any() else normal
        uv: Array = self.principal_px[:, None, :] + self.focal_px[:, None, None] * bent
        return uv

    def camera(self, index: int) -> StereoModel:
        """One camera (LEFT or RIGHT) alone: the same with a first axis of length 1."""
        return StereoModel(*(getattr(self, f.name)[index : index + 1] for f in fields(self)))

    def _normalised(self, points_ih_m: Array) -> tuple[Array, Array]:
        """Coordinates (2, n, 2) at depth 1, and depths (2, n), NaN for points not in front of a camera."""
        y_cam = (points_ih_m - self.position_ih_m[:, None]) @ self.rotation_cam_ih.transpose(0, 2, 1)
        depth = np.where(y_cam[..., 2] > _MIN_DEPTH_M, y_cam[..., 2], np.nan)
        return y_cam[..., :2] / depth[..., None], depth

    def project_with_jacobian(self, points_ih_m: Array) -> tuple[Array, Array]:
        """Pixels (2, n, 2) and their derivative by the point in `ih` (2, n, 2, 3)."""
        normal, depth = self._normalised(as_array("points_ih_m", points_ih_m, (None, 3)))
        bent, bend = distort(normal, self.distortion[:, None, :])
        uv = self.principal_px[:, None, :] + self.focal_px[:, None, None] * bent
        perspective = np.zeros((*depth.shape, 2, 3))
        perspective[..., 0, 0] = perspective[..., 1, 1] = 1.0 / depth
        perspective[..., :, 2] = -normal / depth[..., None]
        J = self.focal_px[:, None, None, None] * (bend @ perspective) @ self.rotation_cam_ih[:, None]
        return uv, J

    def rays_ih(self, uv_px: Array) -> Array:
        """Unit directions (2, n, 3) in `ih` of the lines of sight through pixels (2, n, 2)."""
        uv = as_array("uv_px", uv_px, (2, None, 2))
        bent = (uv - self.principal_px[:, None, :]) / self.focal_px[:, None, None]
        normal = undistort(bent, self.distortion[:, None, :])
        rays = np.concatenate([normal, np.ones((*normal.shape[:-1], 1))], axis=-1)
        rays = np.einsum("cji,cnj->cni", self.rotation_cam_ih, rays)
        unit: Array = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
        return unit

    def inside(self, uv_px: Array, margin_px: float = 0.0) -> NDArray[np.bool_]:
        """Whether pixels (2, n, 2) lie in their frames, `margin_px` from the edge; bool (2, n)."""
        with np.errstate(invalid="ignore"):
            low = (uv_px >= margin_px - 0.5).all(axis=-1)
            high = (uv_px <= self.size_px[:, None, :] - 0.5 - margin_px).all(axis=-1)
        return np.asarray(low & high)


def _rotation_ih_cam(camera: CameraCalibration) -> Array:
    turned = rot_z(camera.yaw_ih_rad) @ rot_y(camera.pitch_ih_rad) @ rot_x(camera.roll_ih_rad)
    return np.asarray(turned @ _IH_CAM_UNTURNED, dtype=np.float64)


def distort(normal: Array, k: Array) -> tuple[Array, Array]:
    """Brown-Conrady distortion of normalised coordinates (..., 2), and its Jacobian (..., 2, 2)."""
    x, y = normal[..., 0], normal[..., 1]
    k1, k2, p1, p2, k3 = (k[..., i] for i in range(5))
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3))  # d radial / d x = slope * x
    bent = np.stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ],
        axis=-1,
    )
    J = np.empty((*normal.shape, 2))
    J[..., 0, 0] = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x
    J[..., 1, 1] = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x
    J[..., 0, 1] = J[..., 1, 0] = slope * x * y + 2 * p1 * x + 2 * p2 * y
    return bent, J


def undistort(bent: Array, k: Array) -> Array:
    """Inverse of `distort` by Newton's method; exact to rounding for lenses that do not fold."""
    normal = bent.copy()
    if not np.any(k):
        return normal
    for _ in range(_UNDISTORT_STEPS):
        got, J = distort(normal, k)
        step = np.linalg.solve(J, (bent - got)[..., None])[..., 0]
        normal = normal + step
    return normal


def triangulate(model: StereoModel, uv_px: Array) -> Array:
    """Points (n, 3) in `ih` nearest to both lines of sight through pixels (2, n, 2); the inverse of eq. 2.

    NaN where a pixel is NaN. Raises ValueError on other shapes.
    """
    rays = model.rays_ih(uv_px)
    # Normal equations of the point with least squared distance to both rays: sum (I - r r^T)(y - c) = 0.
    P = np.eye(3) - rays[..., :, None] * rays[..., None, :]
    A = P.sum(axis=0)
    b = np.einsum("cnij,cj->ni", P, model.position_ih_m)
    seen = np.isfinite(A).all(axis=(1, 2))
    points = np.full((rays.shape[1], 3), np.nan)
    if seen.any():
        points[seen] = np.linalg.solve(A[seen], b[seen][..., None])[..., 0]
    return points
