"""From marker corners to a pose with its covariance, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from yard_robot.marker_box import Array, corners_body_m, frame
from yard_robot.pole_camera import optics, project
from yard_robot.rig import MarkerBox, PoleCamera

CORNER_SIGMA_PX = 0.36
"""Of one corner and axis. Measured by `benchmarks/nees.py`: corners of a marker err together."""

_GRAZING = 0.25  # cosine: what is seen flatter than this has corners that run into its cells
_WRONG_PX = 2.5  # no noise does this: a corner is hidden, or a marker was taken for another
_MOST_TILT = np.cos(np.radians(20.0))  # of the body's up axis: the yard is level
_STEPS = 8


@dataclass(frozen=True, eq=False)
class MarkerPose:
    """Pose of `body` in `site`: place (3,), rotation (3, 3), covariance (6, 6) and the faces it rests on.

    Rotation errors are small rotation vectors in `site` axes.
    """

    position_m: Array
    rotation: Array
    covariance: Array
    faces: tuple[str, ...]


def solve(camera: PoleCamera, box: MarkerBox, seen: Mapping[str, Array]) -> MarkerPose | str:
    """The pose that explains these corners (4, 2 each, by face) [px]; or why there is none."""
    if not seen:
        return "no marker is seen"
    start = _first_guess(camera, box, seen)
    if start is None:
        return f"the {next(iter(seen))} marker alone fits no upright robot"
    faces = tuple(face for face in seen if cosine(camera, box, *start, face) > _GRAZING)
    while faces:
        position, rotation, jacobian, residual = _refined(camera, box, seen, faces, *start)
        worst_px = np.abs(residual).reshape(len(faces), -1).max(axis=1)
        if worst_px.max() <= _WRONG_PX:
            covariance = CORNER_SIGMA_PX**2 * np.linalg.inv(jacobian.T @ jacobian)
            return MarkerPose(position, rotation, (covariance + covariance.T) / 2, faces)
        if len(faces) == 1:
            return f"corners of the {faces[0]} marker are {worst_px.max():.1f} px from where they belong"
        faces = tuple(face for face, px in zip(faces, worst_px, strict=True) if px < worst_px.max())
    return "the markers are seen too flat"


def _first_guess(camera: PoleCamera, box: MarkerBox, seen: Mapping[str, Array]) -> tuple[Array, Array] | None:
    """Place and rotation from the largest marker: of the two poses that a flat marker allows, the upright."""
    face = max(seen, key=lambda name: cv2.contourArea(seen[name].astype(np.float32)))
    matrix, to_camera, place = optics(camera)
    half = box.marker_m / 2
    flat = half * np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]], dtype=np.float64)
    _, turns, shifts, _ = cv2.solvePnPGeneric(flat, seen[face], matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    normal, right, down = frame(face)
    on_body = np.stack([right, -down, normal], axis=1)  # the marker's axes in `body`
    middle = corners_body_m(box, face).mean(axis=0)
    poses = []
    for turn, shift in zip(turns, shifts, strict=True):
        rotation = to_camera.T @ cv2.Rodrigues(turn)[0] @ on_body.T
        poses.append((place + to_camera.T @ shift.ravel() - rotation @ middle, rotation))
    best = max(poses, key=lambda pose: pose[1][2, 2])
    return best if best[1][2, 2] > _MOST_TILT else None


def cosine(camera: PoleCamera, box: MarkerBox, position: Array, rotation: Array, face: str) -> float:
    """Of the angle between a face's normal and the line to the camera."""
    _, _, place = optics(camera)
    sight = place - (position + rotation @ corners_body_m(box, face).mean(axis=0))
    return float(sight @ rotation @ frame(face)[0] / np.linalg.norm(sight))


def _refined(
    camera: PoleCamera,
    box: MarkerBox,
    seen: Mapping[str, Array],
    faces: tuple[str, ...],
    position: Array,
    rotation: Array,
) -> tuple[Array, Array, Array, Array]:
    """Gauss-Newton on all corners: place, rotation, Jacobian (n, 6) and residuals (n,) [px]."""
    body_m = np.concatenate([corners_body_m(box, face) for face in faces])
    corners_px = np.concatenate([seen[face] for face in faces])
    for _ in range(_STEPS):
        jacobian = _jacobian(camera, body_m @ rotation.T, position)
        residual = (corners_px - project(camera, position + body_m @ rotation.T)).ravel()
        step = np.linalg.lstsq(jacobian, residual, rcond=None)[0]
        position = position + step[:3]
        rotation = cv2.Rodrigues(step[3:])[0] @ rotation
    residual = (corners_px - project(camera, position + body_m @ rotation.T)).ravel()
    return position, rotation, _jacobian(camera, body_m @ rotation.T, position), residual


def _jacobian(camera: PoleCamera, arms_m: Array, position: Array) -> Array:
    """Of pixels (2 n) by place and rotation vector in `site`; `arms_m` (n, 3) are points from `body`."""
    _, to_camera, place = optics(camera)
    rays = (position + arms_m - place) @ to_camera.T
    x, y, z = rays.T
    by_ray = np.zeros((len(rays), 2, 3))
    by_ray[:, 0, 0] = by_ray[:, 1, 1] = camera.focal_px / z
    by_ray[:, 0, 2], by_ray[:, 1, 2] = -camera.focal_px * x / z**2, -camera.focal_px * y / z**2
    by_point = by_ray @ to_camera
    zero = np.zeros(len(arms_m))
    ax, ay, az = arms_m.T
    cross = np.stack([zero, -az, ay, az, zero, -ax, -ay, ax, zero], axis=1).reshape(-1, 3, 3)
    jacobian: Array = np.concatenate([by_point, -by_point @ cross], axis=2).reshape(-1, 6)
    return jacobian
