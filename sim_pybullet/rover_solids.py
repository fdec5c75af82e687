"""The rover as convex solids with lit faces: boxes, and belts with their grousers."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Array
from sim_pybullet.scene import Box
from sim_pybullet.shape import belt, rover_boxes

_GROUSER_M = 0.011
# The marker plane is as bright as the ground, so that the noise under a marker is the calibrated one.
_ALBEDO = {"chassis": 0.75, "arm": 1.15, "cabin": 1.0}
_TRACK_ALBEDO, _GROUSER_ALBEDO, _HUB_ALBEDO = 0.34, 0.62, 0.80
_LED_PAD_M, _LED_PAD_ALBEDO = 0.008, 0.93


@dataclass(frozen=True, eq=False)
class Face:
    """A flat convex polygon (k, 3) in its solid's frame, its outward normal, and its reflectance.

    `albedo` is relative to the ground's. `marks` are polygons painted on it, with their own.
    """

    corners: Array
    normal: Array
    albedo: float
    marks: tuple[tuple[Array, float], ...] = ()


@dataclass(frozen=True, eq=False)
class Solid:
    """A convex part of the rover in one of the scene's frames."""

    name: str
    frame: str
    faces: tuple[Face, ...]
    vertices: Array = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", np.vstack([face.corners for face in self.faces]))


def rover_solids(rig: RigCalibration) -> tuple[Solid, ...]:
    """Everything of the rover that shows."""
    solids = []
    for box in rover_boxes(rig):
        if "track" in box.name:
            solids.append(_belt_solid(rig, box))
        else:
            marks = _cabin_marks(rig, box) if box.name == "cabin" else {}
            solids.append(_box_solid(box, _ALBEDO[box.name], marks))
    return tuple(solids)


def _box_solid(box: Box, albedo: float, marks: dict[tuple[int, float], list[tuple[Array, float]]]) -> Solid:
    centre, half = np.array(box.centre_m), np.array(box.size_m) / 2
    faces = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            across, up = (axis + 1) % 3, (axis + 2) % 3
            corners = np.tile(centre, (4, 1))
            corners[:, axis] += sign * half[axis]
            corners[:, across] += half[across] * np.array([-1, 1, 1, -1])
            corners[:, up] += half[up] * np.array([-1, -1, 1, 1])
            faces.append(Face(corners, sign * np.eye(3)[axis], albedo, tuple(marks.get((axis, sign), ()))))
    return Solid(box.name, box.frame, tuple(faces))


def _cabin_marks(rig: RigCalibration, box: Box) -> dict[tuple[int, float], list[tuple[Array, float]]]:
    """A darker plate and the pads of the LEDs on the top, an instrument opening in the front."""
    top_m = box.centre_m[2] + box.size_m[2] / 2
    plate = _rectangle(box.centre_m[0], box.centre_m[1], *rig.shape.plate_m, top_m)
    offset = np.array(rig.cabin.plc_offset_cabin_m)
    pads = [
        (_rectangle(x, y, _LED_PAD_M, _LED_PAD_M, top_m), _LED_PAD_ALBEDO)
        for x, y, _ in np.array(rig.markers.positions_plc_m) + offset
    ]
    front = box.centre_m[0] + box.size_m[0] / 2
    opening = _rectangle(box.centre_m[1], box.centre_m[2], *rig.shape.opening_m, front)[:, [2, 0, 1]]
    return {(2, 1.0): [(plate, 0.72), *pads], (0, 1.0): [(opening, 0.30)]}


def _rectangle(x: float, y: float, width: float, height: float, z: float) -> Array:
    dx, dy = width / 2, height / 2
    return np.array([[x - dx, y - dy, z], [x + dx, y - dy, z], [x + dx, y + dy, z], [x - dx, y + dy, z]])


def _belt_solid(rig: RigCalibration, box: Box) -> Solid:
    """A stadium of the belt's size whose rim is cut into grousers and gaps."""
    size = belt(rig)
    rim = _stadium(size.flat_m, size.radius_m) + np.array([box.centre_m[0], box.centre_m[2]])
    half = size.width_m / 2
    faces = []
    for i, (a, b) in enumerate(zip(rim, np.roll(rim, -1, axis=0), strict=True)):
        y = box.centre_m[1]
        corners = np.array(
            [[a[0], y - half, a[1]], [a[0], y + half, a[1]], [b[0], y + half, b[1]], [b[0], y - half, b[1]]]
        )
        along = (b - a) / np.linalg.norm(b - a)
        faces.append(
            Face(corners, np.array([-along[1], 0.0, along[0]]), (_TRACK_ALBEDO, _GROUSER_ALBEDO)[i % 2])
        )
    for sign in (-1.0, 1.0):
        y = box.centre_m[1] + sign * half
        outside = sign * box.centre_m[1] > 0
        side = np.column_stack([rim[:, 0], np.full(len(rim), y), rim[:, 1]])
        faces.append(
            Face(
                side,
                np.array([0.0, sign, 0.0]),
                _TRACK_ALBEDO,
                _hubs(box, size.flat_m, size.radius_m, y) if outside else (),
            )
        )
    return Solid(box.name, box.frame, tuple(faces))


def _stadium(flat_m: float, radius_m: float) -> Array:
    """Outline in (x, z), from the front bottom backwards along the ground: rim points a grouser apart."""
    flats = max(2, 2 * round(flat_m / (2 * _GROUSER_M)))
    arcs = max(4, 2 * round(math.pi * radius_m / (2 * _GROUSER_M)))
    along = np.linspace(0.5, -0.5, flats, endpoint=False) * flat_m
    angle = np.linspace(0, math.pi, arcs, endpoint=False)
    bottom = np.column_stack([along, np.full(flats, -radius_m)])
    back = np.column_stack([-flat_m / 2 - radius_m * np.sin(angle), -radius_m * np.cos(angle)])
    return np.vstack([bottom, back, -bottom, -back])


def _hubs(box: Box, flat_m: float, radius_m: float, y_m: float) -> tuple[tuple[Array, float], ...]:
    """Wheels seen at the side of a track."""
    angle = np.linspace(0, 2 * math.pi, 14, endpoint=False)
    hubs = []
    for x in np.linspace(-flat_m / 2, flat_m / 2, 4):
        for share, albedo in ((0.62, _HUB_ALBEDO), (0.25, _TRACK_ALBEDO)):
            r = share * radius_m
            ring = np.column_stack(
                [
                    box.centre_m[0] + x + r * np.cos(angle),
                    np.full(len(angle), y_m),
                    box.centre_m[2] + r * np.sin(angle),
                ]
            )
            hubs.append((ring, albedo))
    return tuple(hubs)
