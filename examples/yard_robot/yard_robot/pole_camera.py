"""The fixed camera on its pole: where it looks, and the pictures that PyBullet draws for it."""

from __future__ import annotations

import math

import cv2
import numpy as np
from executive.core.types import Window
from numpy.typing import NDArray

from yard_robot.bullet import pybullet
from yard_robot.marker_box import Array
from yard_robot.rig import PoleCamera

Image = NDArray[np.uint8]
_NEAR_M, _FAR_M = 0.5, 40.0
_FINER = 2  # pixels drawn a pixel, in each direction: TinyRenderer draws hard edges
_FINE_UP_TO_PX = 400_000  # larger windows are for finding the robot, not for measuring it
_NOTHING = 0.9999  # depth, of 1 for the far plane
_GROUND_COUNTS = 125.0


def optics(camera: PoleCamera) -> tuple[Array, Array, Array]:
    """Matrix (3, 3); rotation (3, 3) from `site` to the camera (x right, y down, z ahead); its place."""
    matrix = np.array(
        [
            [camera.focal_px, 0.0, (camera.width_px - 1) / 2],
            [0.0, camera.focal_px, (camera.height_px - 1) / 2],
            [0.0, 0.0, 1.0],
        ]
    )
    c, s = math.cos(camera.pitch_rad), math.sin(camera.pitch_rad)
    right, down, ahead = (0.0, -1.0, 0.0), (-s, 0.0, -c), (c, 0.0, -s)
    return matrix, np.array([right, down, ahead]), np.array([0.0, 0.0, camera.height_m])


def project(camera: PoleCamera, points_site_m: Array) -> Array:
    """Where points (n, 3) show [px], shape (n, 2); NaN for those behind the camera."""
    matrix, rotation, place = optics(camera)
    rays = (points_site_m - place) @ rotation.T
    depth = np.where(rays[:, 2] > _NEAR_M, rays[:, 2], np.nan)
    pixels: Array = (rays @ matrix.T)[:, :2] / depth[:, None]
    return pixels


def window_around(camera: PoleCamera, points_px: Array, margin_px: float) -> Window | None:
    """The part of the sensor that holds these points (n, 2) with a margin; None where that is nothing."""
    if not np.isfinite(points_px).all():
        return None
    low = np.floor(points_px.min(axis=0) - margin_px)
    high = np.ceil(points_px.max(axis=0) + margin_px)
    size = (camera.width_px, camera.height_px)
    (u0, v0), (u1, v1) = np.clip(low, 0, size).astype(int), np.clip(high, 0, size).astype(int)
    if u1 - u0 < 16 or v1 - v0 < 16:
        return None
    return Window(int(u0), int(v0), int(u1 - u0), int(v1 - v0))


def draw(client: int, camera: PoleCamera, window: Window, light: float, rng: np.random.Generator) -> Image:
    """A picture of this window in counts, shape (height, width); `light` is 1 by a clear day."""
    fine = _drawn(client, camera, window)
    grey = np.asarray(cv2.resize(fine, (window.width, window.height), interpolation=cv2.INTER_AREA))
    noisy = light * grey + rng.normal(0.0, camera.noise_counts, grey.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def _drawn(client: int, camera: PoleCamera, window: Window) -> NDArray[np.float32]:
    """The window without noise, finer than its pixels. Where nothing stands there is bare ground.

    The ground is filled in here: TinyRenderer would take longer for it than for the robot.
    """
    finer = _finer(window)
    shape = (window.height * finer, window.width * finer)
    _, _, pixels, depth, _ = pybullet.getCameraImage(
        shape[1],
        shape[0],
        _view_matrix(camera),
        _projection_matrix(camera, window),
        shadow=0,
        lightDirection=(-2.0, 1.0, 6.0),
        lightColor=(1.0, 1.0, 1.0),
        lightAmbientCoeff=0.7,
        lightDiffuseCoeff=0.3,
        lightSpecularCoeff=0.0,
        renderer=pybullet.ER_TINY_RENDERER,
        flags=pybullet.ER_NO_SEGMENTATION_MASK,
        physicsClientId=client,
    )
    grey = np.asarray(pixels, dtype=np.float32).reshape(*shape, 4)[..., :3].mean(axis=2)
    nothing = np.asarray(depth).reshape(shape) > _NOTHING
    return np.where(nothing, np.float32(_GROUND_COUNTS), grey)


def _finer(window: Window) -> int:
    return _FINER if window.width * window.height <= _FINE_UP_TO_PX else 1


def _view_matrix(camera: PoleCamera) -> list[float]:
    _, rotation, place = optics(camera)
    ahead, up = rotation[2], -rotation[1]
    matrix: list[float] = pybullet.computeViewMatrix(place.tolist(), (place + ahead).tolist(), up.tolist())
    return matrix


def _projection_matrix(camera: PoleCamera, window: Window) -> list[float]:
    """The part of the camera's field that falls on the window; pixel (0, 0) has its middle at (0, 0).

    TinyRenderer samples the corners of its pixels, not their middles, hence the half of one.
    """
    half_px = 0.5 / _finer(window)
    middle_u, middle_v = (camera.width_px - 1) / 2 - half_px, (camera.height_px - 1) / 2 + half_px
    left, right = (window.u - 0.5 - middle_u, window.u + window.width - 0.5 - middle_u)
    top, bottom = (middle_v - window.v + 0.5, middle_v - window.v - window.height + 0.5)
    scale = _NEAR_M / camera.focal_px
    matrix: list[float] = pybullet.computeProjectionMatrix(
        left * scale, right * scale, bottom * scale, top * scale, _NEAR_M, _FAR_M
    )
    return matrix
