"""The simulator's own camera geometry: true head angles to camera poses, points to pixels, pixels to rays.

Written apart from perception on purpose, so that an error in one shows in the other. Pixel (0, 0) is the
centre of the first pixel. Camera axes: z forward, x right, y down.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.rig import CameraCalibration, HeadCalibration, RigCalibration
from executive.core.types import Array
from sim_pybullet.scene import SceneState
from sim_pybullet.seeing import CLEAN, Lens, Seeing

_UNDISTORT_STEPS = 12
_CAMERA_AXES_IH = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True, eq=False)
class PlacedCamera:
    """A camera somewhere in `site`: `R_site_cam` (3, 3) turns camera vectors into site."""

    camera: CameraCalibration
    R_site_cam: Array
    position_site_m: Array
    lens: Lens = CLEAN

    def project(self, points_site_m: Array) -> tuple[Array, Array]:
        """Points (..., 3) to pixels (..., 2) and depths (...) [m]; NaN pixels for points not in front."""
        in_cam = (np.asarray(points_site_m) - self.position_site_m) @ self.R_site_cam
        depth = in_cam[..., 2]
        ahead = depth > 1e-6
        safe = np.where(ahead, depth, 1.0)
        x, y = distort(self.camera, in_cam[..., 0] / safe, in_cam[..., 1] / safe)
        u = self.camera.principal_px[0] + self.camera.focal_px * x
        v = self.camera.principal_px[1] + self.camera.focal_px * y
        uv = np.stack([u, v], axis=-1)
        uv[~ahead] = np.nan
        return uv, depth

    def rays(self, u_px: Array, v_px: Array) -> Array:
        """Directions (..., 3) in `site` of the rays through pixels, scaled to depth 1."""
        xd = (np.asarray(u_px, dtype=np.float64) - self.camera.principal_px[0]) / self.camera.focal_px
        yd = (np.asarray(v_px, dtype=np.float64) - self.camera.principal_px[1]) / self.camera.focal_px
        x, y = undistort(self.camera, xd, yd)
        in_cam = np.stack([x, y, np.ones_like(x)], axis=-1)
        return in_cam @ self.R_site_cam.T


def distort(camera: CameraCalibration, x: Array, y: Array) -> tuple[Array, Array]:
    """Brown-Conrady (k1, k2, p1, p2, k3) on normalised coordinates."""
    if not any(camera.distortion):
        return x, y
    k1, k2, p1, p2, k3 = camera.distortion
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def undistort(camera: CameraCalibration, xd: Array, yd: Array) -> tuple[Array, Array]:
    """The inverse of `distort`, by fixed-point iteration (converges for the mild lenses meant here)."""
    x, y = np.array(xd), np.array(yd)
    if not any(camera.distortion):
        return x, y
    for _ in range(_UNDISTORT_STEPS):
        xe, ye = distort(camera, x, y)
        x, y = x + (xd - xe), y + (yd - ye)
    return x, y


def head_views(rig: RigCalibration, pan_rad: float, tilt_rad: float) -> tuple[PlacedCamera, PlacedCamera]:
    """Both cameras for these *true* readings of perfect encoders; the mast's foot is the site's origin."""
    left, right = (_view(rig, camera, pan_rad, tilt_rad) for camera in rig.cameras)
    return left, right


def scene_views(rig: RigCalibration, scene: SceneState) -> tuple[PlacedCamera, PlacedCamera]:
    """Both cameras as they truly stand in a scene, wherever the lander has settled to."""
    views = head_views(rig, scene.head_pan_rad, scene.head_tilt_rad)
    left, right = (
        replace(_settled(view, scene.seeing), lens=lens)
        for view, lens in zip(views, scene.seeing.lenses, strict=True)
    )
    return left, right


def _settled(view: PlacedCamera, seeing: Seeing) -> PlacedCamera:
    if not (any(seeing.lander_shift_m) or any(seeing.lander_turn_rad)):
        return view
    turn = Rotation.from_rotvec(seeing.lander_turn_rad).as_matrix()
    position = turn @ view.position_site_m + seeing.lander_shift_m
    return replace(view, R_site_cam=turn @ view.R_site_cam, position_site_m=position)


def _view(rig: RigCalibration, camera: CameraCalibration, pan_rad: float, tilt_rad: float) -> PlacedCamera:
    R_site_ih = _head_in_site(rig.head, pan_rad, tilt_rad)
    R_ih_cam = about_z(camera.yaw_ih_rad) @ about_y(camera.pitch_ih_rad) @ about_x(camera.roll_ih_rad)
    position = np.array([0.0, 0.0, rig.head.mast_height_m]) + R_site_ih @ np.array(camera.position_ih_m)
    return PlacedCamera(camera, R_site_ih @ R_ih_cam @ _CAMERA_AXES_IH, position)


def _head_in_site(head: HeadCalibration, pan_rad: float, tilt_rad: float) -> Array:
    """R_site_ih: the leaning mast, pan, axes out of square, tilt."""
    mast = about_y(head.lean_rad[1]) @ about_x(head.lean_rad[0])
    panned = mast @ about_z(pan_rad + head.pan_zero_rad)
    turned: Array = panned @ about_x(head.axes_skew_rad) @ about_y(tilt_rad + head.tilt_zero_rad)
    return turned


def about_x(angle_rad: float) -> Array:
    """Rotation about x, shape (3, 3)."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def about_z(angle_rad: float) -> Array:
    """Rotation about z, shape (3, 3)."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def about_y(angle_rad: float) -> Array:
    """Rotation about y, shape (3, 3)."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
