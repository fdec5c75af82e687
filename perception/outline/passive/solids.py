"""The rover's visible surfaces, from the rig's drawing: convex solids of flat facets, in frame `body`.

Made from the values of `executive.core.rig` alone, apart from how the simulator draws its rover.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.rig import RigCalibration
from executive.core.types import Array, Vec2
from perception.geometry.body import Transform, plc_in_body
from perception.geometry.rotation import rot_y

Indices = NDArray[np.intp]

_ARC_STEPS = 12  # of a belt's round end; a step is 9 mm of rim
_ARC_SHADES = 4  # brightnesses along it


@dataclass(frozen=True, eq=False)
class Solids:
    """All facets, stacked. Facets wind counter-clockwise seen from outside.

    `vertices_m` (v, 3); `edges` (e, 2) from vertex to vertex, of facet `edge_facet` (e,). Per facet (f,): a
    `point_m` (f, 3) on it, its outward `normal` (f, 3), its `shade` (facets of one shade are equally bright),
    its `solid`, and the shade `over` which it is painted, -1 for none. Per shade (s,): `shade_solid` and
    `shade_over`.
    """

    vertices_m: Array
    edges: Indices
    edge_facet: Indices
    point_m: Array
    normal: Array
    shade: Indices
    solid: Indices
    over: Indices
    shade_solid: Indices
    shade_over: Indices

    def solid_vertices(self, solid: int) -> Array:
        """Vertices (k, 3) of one solid."""
        edges = self.edges[self.solid[self.edge_facet] == solid]
        corners: Array = self.vertices_m[np.unique(edges)]
        return corners


@dataclass(frozen=True)
class _Facet:
    corners_m: Array
    shade: str
    solid: int
    over: str = ""


def rover_solids(rig: RigCalibration, joints_rad: Vec2) -> Solids:
    """The rover with its cabin at these joint angles (arm, cabin)."""
    shape, size = rig.shape, rig.rover
    belt_width = size.width_m - size.track_gauge_m
    facets: list[_Facet] = []
    for solid, side in ((0, 1.0), (1, -1.0)):
        facets += _belt(rig, solid, side * size.track_gauge_m / 2, belt_width)
    chassis = (
        shape.chassis_length_m,
        size.track_gauge_m - belt_width - shape.chassis_gap_m,
        shape.chassis_height_m,
    )
    level = Transform(np.eye(3), np.zeros(3))
    facets += _box(2, level, (0.0, 0.0, shape.belly_clearance_m + chassis[2] / 2), chassis)
    arm = Transform(rot_y(-joints_rad[0]), np.array(rig.cabin.arm_pivot_body_m))
    bar = (rig.cabin.arm_length_m, shape.arm_width_m, shape.arm_thickness_m)
    facets += _box(3, arm, (bar[0] / 2, 0.0, 0.0), bar)
    plc = plc_in_body(rig.cabin, *joints_rad)
    facets += _box(4, plc, (0.0, 0.0, -shape.cabin_size_m[2] / 2), shape.cabin_size_m)
    facets += _marks(rig, plc)
    return _stacked(facets)


def _box(solid: int, frame: Transform, centre_m: Sequence[float], size_m: Sequence[float]) -> list[_Facet]:
    facets = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * _sides_across(size_m, axis) / 2
            if sign < 0:
                square = square[::-1]
            corners = np.empty((4, 3))
            corners[:, axis] = sign * size_m[axis] / 2
            corners[:, (axis + 1) % 3], corners[:, (axis + 2) % 3] = square.T
            name = f"{solid} {'-+'[sign > 0]}{'xyz'[axis]}"
            facets.append(_Facet(frame.apply(corners + np.array(centre_m)), name, solid))
    return facets


def _sides_across(size_m: Sequence[float], axis: int) -> Array:
    """The two sides of a box's facet across `axis`."""
    return np.array([size_m[(axis + 1) % 3], size_m[(axis + 2) % 3]])


def _marks(rig: RigCalibration, plc: Transform) -> list[_Facet]:
    """The plate on the cabin's top and the opening in its front."""
    length, _, height = rig.shape.cabin_size_m
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    top = np.column_stack([square * rig.shape.plate_m, np.zeros(4)])
    across, up = (square * rig.shape.opening_m).T
    front = np.column_stack([np.full(4, length / 2), across, up - height / 2])
    return [
        _Facet(plc.apply(top), "plate", 4, over="4 +z"),
        _Facet(plc.apply(front), "opening", 4, over="4 +x"),
    ]


def _belt(rig: RigCalibration, solid: int, y_m: float, width_m: float) -> list[_Facet]:
    """A belt as a prism: two flanks, and the rim in strips whose brightness changes along the round ends."""
    radius = rig.shape.belt_radius_m
    flat = rig.rover.length_m - rig.shape.belt_shorter_m - 2 * radius
    angle = np.linspace(-np.pi / 2, np.pi / 2, _ARC_STEPS + 1)
    front = np.column_stack([flat / 2 + radius * np.cos(angle), radius * np.sin(angle)])
    rim = np.vstack([front, -front]) + np.array(
        [0.0, radius]
    )  # counter-clockwise in (x, z), from below the front
    facets = []
    low, high = y_m - width_m / 2, y_m + width_m / 2
    for i, (a, b) in enumerate(zip(rim, np.roll(rim, -1, axis=0), strict=True)):
        end, step = divmod(i, _ARC_STEPS + 1)
        part = "flat" if step == _ARC_STEPS else f"arc {step * _ARC_SHADES // _ARC_STEPS}"
        corners = np.array([[a[0], low, a[1]], [a[0], high, a[1]], [b[0], high, b[1]], [b[0], low, b[1]]])
        facets.append(_Facet(corners, f"{solid} {end} {part}", solid))
    for y, order in ((low, 1), (high, -1)):
        flank = np.column_stack([rim[:, 0], np.full(len(rim), y), rim[:, 1]])[::order]
        facets.append(_Facet(flank, f"{solid} flank {order}", solid))
    return facets


def _stacked(facets: list[_Facet]) -> Solids:
    names = list(dict.fromkeys(f.shade for f in facets))
    index = {name: i for i, name in enumerate(names)} | {"": -1}
    first = np.cumsum([0] + [len(f.corners_m) for f in facets])
    edges = [
        np.column_stack([np.arange(n), np.roll(np.arange(n), -1)]) + start
        for n, start in zip([len(f.corners_m) for f in facets], first, strict=False)
    ]
    normals = np.array([_normal(f.corners_m) for f in facets])
    solid_of = {f.shade: f.solid for f in facets}
    over_of = {f.shade: f.over for f in facets}
    return Solids(
        vertices_m=np.vstack([f.corners_m for f in facets]),
        edges=np.vstack(edges),
        edge_facet=np.repeat(np.arange(len(facets)), [len(f.corners_m) for f in facets]),
        point_m=np.array([f.corners_m[0] for f in facets]),
        normal=normals,
        shade=np.array([index[f.shade] for f in facets]),
        solid=np.array([f.solid for f in facets]),
        over=np.array([index[f.over] for f in facets]),
        shade_solid=np.array([solid_of[name] for name in names]),
        shade_over=np.array([index[over_of[name]] for name in names]),
    )


def _normal(corners: Array) -> Array:
    """Newell's normal, for corners counter-clockwise seen from where it points to."""
    ahead = np.roll(corners, -1, axis=0)
    normal = np.cross(corners, ahead).sum(axis=0)
    unit: Array = normal / np.linalg.norm(normal)
    return unit
