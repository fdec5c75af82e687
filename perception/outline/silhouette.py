"""The rover as lines: the edges that one camera would see, drawn at a pose, hidden ones left out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.rig import RigCalibration
from executive.core.types import Array, Vec2
from perception.frames.steadying import Picture
from perception.geometry.body import Transform
from perception.geometry.camera import StereoModel
from perception.geometry.chain import Chain
from perception.outline.passive.hiding import near_first
from perception.outline.passive.solids import Indices, Solids, rover_solids

_JOINT_STEP_RAD = 1e-3  # joints nearer to each other than this share a drawing
_EYE_STEPS = 10  # of a direction's unit length, for the order in which solids hide one another
_EYE_M = 10.0
_INNER = 0.5  # an edge between two surfaces shows less often than one against the ground
_LEAST_CORNERS = 4  # strips of a belt's rim have no edges that show: told by their number
_SHIFT_BITS = 4
_MARGIN_PX = 5


@dataclass(frozen=True, eq=False)
class _Solid:
    """Vertices of a convex solid, and its facets as (index, corners in turn)."""

    vertices: Indices
    facets: tuple[tuple[int, Indices], ...]


@dataclass(frozen=True, eq=False)
class Sketch:
    """Lines (h, w) from 0 to 1, and the solid body (h, w) as 1 or 0, from pixel `corner` (u, v) on."""

    lines: Picture
    body: NDArray[np.uint8]
    corner: Array


@dataclass(frozen=True, eq=False)
class Outline:
    """One camera's view of the rover, in pixels of `binning` x `binning` full ones from `corner_px` on."""

    chain: Chain
    joints_rad: Vec2
    head_rad: Vec2
    camera: int
    binning: int
    corner_px: tuple[int, int]

    @cached_property
    def _ih_site(self) -> Transform:
        return self.chain.site_ih(self.head_rad).inverse()

    @cached_property
    def _model(self) -> StereoModel:
        return self.chain.model.camera(self.camera)

    def pixels(self, points_site_m: Array) -> Array:
        """Binned pixels (n, 2) of points (n, 3) in site."""
        uv = self._model.project(self._ih_site.apply(points_site_m))[0]
        return np.asarray((uv + 0.5 - self.corner_px) / self.binning - 0.5)

    def full_px(self, uv: Array) -> Array:
        """Full-frame pixels of binned ones (..., 2)."""
        return np.asarray((uv + 0.5) * self.binning - 0.5 + self.corner_px)

    def sketch(self, site_body: Transform, blur_px: float) -> Sketch | None:
        """The rover's lines at a pose, from far to near; None where it is not in front of the camera."""
        solids, parts = _parts(self.chain.rig, *_rounded(self.joints_rad))
        uv = self.pixels(site_body.apply(solids.vertices_m))
        if not np.isfinite(uv).all():
            return None
        low, high = np.floor(uv.min(axis=0)) - _MARGIN_PX, np.ceil(uv.max(axis=0)) + _MARGIN_PX
        width, height = (int(x) + 1 for x in high - low)
        points = np.round((uv - low) * 2**_SHIFT_BITS).astype(np.int32)
        eye = self._eye_body(site_body)
        facing = ((eye - solids.point_m) * solids.normal).sum(axis=1) > 0
        lines, body = np.zeros((height, width), np.uint8), np.zeros((height, width), np.uint8)
        for solid in self._far_first(eye):
            _draw(lines, body, parts[solid], points, facing)
        blurred = cv2.GaussianBlur(lines.astype(np.float32) / 255, (0, 0), blur_px)
        return Sketch(np.asarray(blurred, dtype=np.float32), body, low)

    def _eye_body(self, site_body: Transform) -> Array:
        """The camera (3,) in the rover's body [m]."""
        eye_site = self._ih_site.inverse().apply(self._model.position_ih_m)
        eye: Array = site_body.inverse().apply(eye_site)[0]
        return eye

    def _far_first(self, eye_body_m: Array) -> tuple[int, ...]:
        direction = np.round(_EYE_STEPS * eye_body_m / np.linalg.norm(eye_body_m))
        return _hiding(self.chain.rig, _rounded(self.joints_rad), tuple(direction.tolist()))[::-1]


def _draw(
    lines: NDArray[np.uint8],
    body: NDArray[np.uint8],
    solid: _Solid,
    points: NDArray[np.int32],
    facing: NDArray[np.bool_],
) -> None:
    """Draw a convex solid over what lies behind it."""
    hull = cv2.convexHull(points[solid.vertices])
    cv2.fillConvexPoly(lines, hull, 0, shift=_SHIFT_BITS)
    cv2.fillConvexPoly(body, hull, 1, shift=_SHIFT_BITS)
    for facet, corners in solid.facets:
        if facing[facet]:
            cv2.polylines(lines, [points[corners]], True, int(255 * _INNER), 1, cv2.LINE_AA, _SHIFT_BITS)
    cv2.polylines(lines, [hull], True, 255, 1, cv2.LINE_AA, _SHIFT_BITS)


def _rounded(joints_rad: Vec2) -> Vec2:
    arm, cabin = (round(angle / _JOINT_STEP_RAD) * _JOINT_STEP_RAD for angle in joints_rad)
    return arm, cabin


@lru_cache(maxsize=8)
def _parts(rig: RigCalibration, arm_rad: float, cabin_rad: float) -> tuple[Solids, tuple[_Solid, ...]]:
    solids = rover_solids(rig, (arm_rad, cabin_rad))
    corners = [solids.edges[solids.edge_facet == facet][:, 0] for facet in range(len(solids.point_m))]
    parts = []
    for solid in range(int(solids.solid.max()) + 1):
        own = [(facet, corners[facet]) for facet in np.flatnonzero(solids.solid == solid).tolist()]
        most = max(len(turn) for _, turn in own)
        shown = tuple((f, turn) for f, turn in own if most == _LEAST_CORNERS or len(turn) > _LEAST_CORNERS)
        parts.append(_Solid(np.unique(np.concatenate([turn for _, turn in own])), shown))
    return solids, tuple(parts)


@lru_cache(maxsize=256)
def _hiding(rig: RigCalibration, joints_rad: Vec2, direction: tuple[float, ...]) -> tuple[int, ...]:
    """Solids from near to far, seen from far off in about this direction (in steps, body axes)."""
    solids, _ = _parts(rig, *joints_rad)
    eye = np.array(direction)
    return near_first(solids, _EYE_M * eye / np.linalg.norm(eye))
