"""The stereo camera model: frames `ih` -> `cam_left`/`cam_right` -> pixels (paper, eq. 2), and back."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from executive.core.rig import CameraCalibration, RigCalibration
from executive.core.types import Array
from perception.geometry.checks import as_array
from perception.geometry.rotation import rot_x, rot_y, rot_z
from perception.kernels.compiled import plain
from perception.kernels.optics import Optics, pixels, rays, triangulated

# Columns: camera x (right), y (down), z (forward) in ih axes (x forward, y left, z up).
_IH_CAM_UNTURNED = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


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

    @cached_property
    def optics(self) -> Optics:
        """The same for the kernels."""
        parts = (self.rotation_cam_ih, self.position_ih_m, self.focal_px, self.principal_px, self.distortion)
        return Optics(*map(plain, parts))

    def project(self, points_ih_m: Array) -> Array:
        """Pixels (2, n, 2) of points (n, 3) in `ih`; NaN for points not in front of a camera."""
        return self.project_with_jacobian(points_ih_m)[0]

    def camera(self, index: int) -> StereoModel:
        """One camera (LEFT or RIGHT) alone: the same with a first axis of length 1."""
        return StereoModel(*(getattr(self, f.name)[index : index + 1] for f in fields(self)))

    def project_with_jacobian(self, points_ih_m: Array) -> tuple[Array, Array]:
        """Pixels (2, n, 2) and their derivative by the point in `ih` (2, n, 2, 3)."""
        return pixels(self.optics, plain(as_array("points_ih_m", points_ih_m, (None, 3))))

    def rays_ih(self, uv_px: Array) -> Array:
        """Unit directions (2, n, 3) in `ih` of the lines of sight through pixels (2, n, 2)."""
        return rays(self.optics, plain(as_array("uv_px", uv_px, (2, None, 2))))

    def inside(self, uv_px: Array, margin_px: float = 0.0) -> NDArray[np.bool_]:
        """Whether pixels (2, n, 2) lie in their frames, `margin_px` from the edge; bool (2, n)."""
        with np.errstate(invalid="ignore"):
            low = (uv_px >= margin_px - 0.5).all(axis=-1)
            high = (uv_px <= self.size_px[:, None, :] - 0.5 - margin_px).all(axis=-1)
        return np.asarray(low & high)


def _rotation_ih_cam(camera: CameraCalibration) -> Array:
    turned = rot_z(camera.yaw_ih_rad) @ rot_y(camera.pitch_ih_rad) @ rot_x(camera.roll_ih_rad)
    return np.asarray(turned @ _IH_CAM_UNTURNED, dtype=np.float64)


def triangulate(model: StereoModel, uv_px: Array) -> Array:
    """Points (n, 3) in `ih` nearest to both lines of sight through pixels (2, n, 2); the inverse of eq. 2.

    NaN where a pixel is NaN. Raises ValueError on other shapes.
    """
    return triangulated(model.optics, plain(as_array("uv_px", uv_px, (2, None, 2))))
