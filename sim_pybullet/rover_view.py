"""The rover in an image: its faces at the true poses, anti-aliased, and its shadow on the ground."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.rig import RigCalibration
from executive.core.types import Array, Window
from sim_pybullet.projection import PlacedCamera
from sim_pybullet.raycast import HeightField
from sim_pybullet.rover_solids import Solid, rover_solids
from sim_pybullet.scene import SceneState
from sim_pybullet.sunlight import SKYLIGHT, Sun

Image = NDArray[np.float32]

_SHIFT = 6  # fractional bits of polygon corners
# OpenCV paints every sample that an outline touches, half a sample too many on each side. Samples a pixel, by
# the size [px] up to which they are affordable: a rover far away must not look larger than it is.
_SAMPLES = ((70.0, 16), (140.0, 8), (260.0, 4))
_TOUCHING_M = 2e-4  # less than the millimetre between arm and cabin
_LEAST_SINE = 0.03  # of the sun's height over the ground


@dataclass(frozen=True, eq=False)
class _Placed:
    """A solid in `site`: faces as (corners, normal, albedo, marks)."""

    vertices: Array
    polygons: tuple[tuple[Array, Array, float], ...]
    planes: tuple[tuple[Array, Array], ...]


class RoverRenderer:
    """Draws the rover over an image of the ground."""

    def __init__(self, rig: RigCalibration, sun: Sun, field: HeightField) -> None:
        self._solids = rover_solids(rig)
        self.sun, self._field = sun, field

    def shade_ground(self, image: Image, scene: SceneState, view: PlacedCamera, window: Window) -> None:
        """Darken the ground where the rover keeps the sun off, in place."""
        shapes = [self._shadow(_vertices(solid, scene), scene) for solid in self._solids]
        hulls = [hull for hull in (_projected_hull(view, shape) for shape in shapes) if hull is not None]
        canvas = _Canvas.around(hulls, window, _oversampling(hulls))
        if canvas is None:
            return
        for hull in hulls:
            canvas.fill(hull, 1.0)
        shadow, _ = canvas.reduced()
        image[canvas.part] *= 1 - np.float32(1 - SKYLIGHT) * shadow

    def draw(self, image: Image, scene: SceneState, view: PlacedCamera, window: Window) -> None:
        """Paint the rover over the image (h, w), in place."""
        placed = [_place(solid, scene) for solid in self._solids]
        outlines = [view.project(part.vertices) for part in placed]
        if any((depth <= 0.05).any() for _, depth in outlines):
            return
        spans = [uv for uv, _ in outlines]
        canvas = _Canvas.around(spans, window, _oversampling(spans))
        if canvas is None:
            return
        for part in _far_to_near(placed, view.position_site_m):
            for corners, normal, albedo in part.polygons:
                if (view.position_site_m - corners[0]) @ normal > 0:
                    canvas.fill(view.project(corners)[0], albedo * float(self.sun.irradiance(normal)))
        radiance, cover = canvas.reduced()
        image[canvas.part] = image[canvas.part] * (1 - cover) + radiance

    def _shadow(self, vertices: Array, scene: SceneState) -> Array:
        """Where the rays past these points from the sun meet the tangent plane of the ground at the rover."""
        foot = scene.T_site_body[:3, 3]
        normal = self._ground_normal(foot)
        ground = np.array([foot[0], foot[1], self._height(foot[0], foot[1])])
        toward = self.sun.direction_site
        # Ground that leans away from the sun is dark of itself: a bounded shadow does for it.
        along = ((vertices - ground) @ normal) / max(float(toward @ normal), _LEAST_SINE)
        return np.asarray(vertices - np.maximum(along, 0)[:, None] * toward)

    def _ground_normal(self, foot: Array, arm_m: float = 0.2) -> Array:
        gx = (self._height(foot[0] + arm_m, foot[1]) - self._height(foot[0] - arm_m, foot[1])) / (2 * arm_m)
        gy = (self._height(foot[0], foot[1] + arm_m) - self._height(foot[0], foot[1] - arm_m)) / (2 * arm_m)
        normal = np.array([-gx, -gy, 1.0])
        return np.asarray(normal / np.linalg.norm(normal))

    def _height(self, x_m: float, y_m: float) -> float:
        return float(self._field.height(np.array([x_m], np.float32), np.array([y_m], np.float32))[0])


@dataclass(eq=False)
class _Canvas:
    """A supersampled piece of the window to paint polygons on."""

    window: Window
    u: int
    v: int
    scale: int
    values: Image
    cover: NDArray[np.uint8]

    @classmethod
    def around(cls, outlines: Iterable[Array], window: Window, scale: int) -> _Canvas | None:
        """A canvas over what these pixel outlines cover of the window; None if they miss it."""
        spans = list(outlines)
        if not spans:
            return None
        every = np.vstack(spans)
        low = np.maximum(np.floor(every.min(axis=0)).astype(int) - 2, (window.u, window.v))
        limit = (window.u + window.width, window.v + window.height)
        high = np.minimum(np.ceil(every.max(axis=0)).astype(int) + 3, limit)
        if (high <= low).any():
            return None
        shape = ((high[1] - low[1]) * scale, (high[0] - low[0]) * scale)
        return cls(
            window, int(low[0]), int(low[1]), scale, np.zeros(shape, np.float32), np.zeros(shape, np.uint8)
        )

    @property
    def part(self) -> tuple[slice, slice]:
        """Where this canvas lies in the window's image."""
        row, column = self.v - self.window.v, self.u - self.window.u
        rows, columns = (n // self.scale for n in self.values.shape)
        return slice(row, row + rows), slice(column, column + columns)

    def fill(self, outline_px: Array, value: float) -> None:
        """Paint a convex polygon (k, 2) given in full-frame pixels."""
        at = (outline_px - (self.u, self.v) + 0.5) * self.scale - 0.5
        corners = np.round(np.clip(at, -1e5, 1e5) * (1 << _SHIFT)).astype(np.int32)
        cv2.fillConvexPoly(self.values, corners, value, cv2.LINE_8, _SHIFT)
        cv2.fillConvexPoly(self.cover, corners, 255, cv2.LINE_8, _SHIFT)

    def reduced(self) -> tuple[Image, Image]:
        """Painted values (0 elsewhere) and cover 0..1, at pixel resolution."""
        rows, columns = (n // self.scale for n in self.values.shape)
        values = cv2.resize(self.values, (columns, rows), interpolation=cv2.INTER_AREA)
        cover = cv2.resize(self.cover, (columns, rows), interpolation=cv2.INTER_AREA)
        return np.asarray(values), np.asarray(cover, dtype=np.float32) / np.float32(255)


def _oversampling(outlines: list[Array]) -> int:
    """Samples a pixel along each axis: more for a small rover, two for one that fills the window."""
    if not outlines:
        return 2
    size_px = float(np.ptp(np.vstack(outlines), axis=0).max())
    return next((samples for limit_px, samples in _SAMPLES if size_px < limit_px), 2)


def _vertices(solid: Solid, scene: SceneState) -> Array:
    T = scene.T_site(solid.frame)
    return np.asarray(solid.vertices @ T[:3, :3].T + T[:3, 3])


def _place(solid: Solid, scene: SceneState) -> _Placed:
    T = scene.T_site(solid.frame)
    R, t = T[:3, :3], T[:3, 3]
    polygons, planes = [], []
    for face in solid.faces:
        normal = R @ face.normal
        corners = face.corners @ R.T + t
        planes.append((corners[0], normal))
        polygons.append((corners, normal, face.albedo))
        polygons += [(mark @ R.T + t, normal, albedo) for mark, albedo in face.marks]
    return _Placed(_vertices(solid, scene), tuple(polygons), tuple(planes))


def _far_to_near(parts: list[_Placed], eye: Array) -> list[_Placed]:
    """An order of painting: a part comes before every part that may hide some of it."""
    waiting, order = list(parts), []
    while waiting:
        free = [p for p in waiting if not any(_must_follow(p, o, eye) for o in waiting if o is not p)]
        # Parts that pass through each other may hide one another in a ring: then the farthest goes first.
        chosen = max(free or waiting, key=lambda p: float(np.linalg.norm(p.vertices.mean(axis=0) - eye)))
        order.append(chosen)
        waiting = [p for p in waiting if p is not chosen]
    return order


def _must_follow(part: _Placed, other: _Placed, eye: Array) -> bool:
    """Whether `part` may hide some of `other`; not where either could: they lie side by side."""
    return _hides(part, other, eye) and not _hides(other, part, eye)


def _hides(front: _Placed, back: _Placed, eye: Array) -> bool:
    """Whether a plane of either part leaves `front` alone on the eye's side."""
    for point, normal in back.planes:
        if (eye - point) @ normal > 0 and ((front.vertices - point) @ normal > -_TOUCHING_M).all():
            return True
    for point, normal in front.planes:
        if (eye - point) @ normal < 0 and ((back.vertices - point) @ normal > -_TOUCHING_M).all():
            return True
    return False


def _projected_hull(view: PlacedCamera, points: Array) -> Array | None:
    uv, depth = view.project(points)
    if (depth <= 0.05).any():
        return None
    return np.asarray(cv2.convexHull(uv.astype(np.float32))[:, 0, :], dtype=np.float64)
