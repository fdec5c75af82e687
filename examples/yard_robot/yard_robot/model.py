"""The robot as it is drawn: chassis, wheels and the box of markers, in a scene of their own.

A scene apart from the physics, because TinyRenderer draws whatever a client holds: the husky's meshes take
twenty times as long as these solids, and an endless ground longer than both.
"""

from __future__ import annotations

import math

import numpy as np

from yard_robot.bullet import pybullet
from yard_robot.marker_box import FACES, Array, bits, on_face
from yard_robot.rig import Husky, MarkerBox, Vec3

_WHITE, _BLACK, _CLOTH = (0.95, 0.95, 0.93, 1.0), (0.03, 0.03, 0.03, 1.0), (0.45, 0.50, 0.40, 1.0)
_YELLOW, _RUBBER = (0.75, 0.60, 0.10, 1.0), (0.12, 0.12, 0.12, 1.0)
_UNDERGROUND = (0.0, 0.0, -50.0)
_LIFT_M = 0.001  # of a marker's cells over the face they are painted on

Quat = tuple[float, float, float, float]
Colour = tuple[float, float, float, float]


class HuskyModel:
    """The drawn robot. Faces of its box in `covered` show plain cloth instead of their markers."""

    def __init__(self, husky: Husky, box: MarkerBox) -> None:
        self.client = int(pybullet.connect(pybullet.DIRECT))
        self.covered: frozenset[str] = frozenset()
        self._hull = [
            _solid(self.client, box.centre_body_m, _CLOTH, (box.edge_m / 2,) * 3),
            _solid(self.client, (0.0, 0.0, husky.chassis_middle_m), _YELLOW, _chassis(husky)),
            *(_wheel(self.client, husky, at_m) for at_m in _axles(husky)),
        ]
        self._faces = {face: _marker(self.client, box, number, face) for number, face in enumerate(FACES)}

    def put(self, position_m: Vec3, quat: Quat) -> None:
        """Put it where the robot is, before a picture."""
        for body in self._hull:
            self._put(body, position_m, quat)
        for face, body in self._faces.items():
            self._put(body, _UNDERGROUND if face in self.covered else position_m, quat)

    def _put(self, body: int, position_m: Vec3, quat: Quat) -> None:
        pybullet.resetBasePositionAndOrientation(body, position_m, quat, physicsClientId=self.client)

    def close(self) -> None:
        """Release the scene; may be called twice."""
        if self.client >= 0:
            pybullet.disconnect(physicsClientId=self.client)
            self.client = -1


def _chassis(husky: Husky) -> Vec3:
    return husky.length_m / 2, husky.chassis_width_m / 2, husky.chassis_height_m / 2


def _axles(husky: Husky) -> list[Vec3]:
    x, y, z = husky.axle_m, husky.wheel_track_m / 2, husky.wheel_radius_m
    return [(-x, -y, z), (-x, y, z), (x, -y, z), (x, y, z)]


def _solid(client: int, at_body_m: Vec3, colour: Colour, half_m: Vec3) -> int:
    shape = pybullet.createVisualShape(
        pybullet.GEOM_BOX,
        halfExtents=half_m,
        rgbaColor=colour,
        visualFramePosition=at_body_m,
        physicsClientId=client,
    )
    return int(pybullet.createMultiBody(baseVisualShapeIndex=shape, physicsClientId=client))


def _wheel(client: int, husky: Husky, at_body_m: Vec3) -> int:
    shape = pybullet.createVisualShape(
        pybullet.GEOM_CYLINDER,
        radius=husky.wheel_radius_m,
        length=husky.wheel_width_m,
        rgbaColor=_RUBBER,
        visualFramePosition=at_body_m,
        visualFrameOrientation=pybullet.getQuaternionFromEuler((math.pi / 2, 0.0, 0.0)),
        physicsClientId=client,
    )
    return int(pybullet.createMultiBody(baseVisualShapeIndex=shape, physicsClientId=client))


def _marker(client: int, box: MarkerBox, number: int, face: str) -> int:
    """A marker as two meshes: white paper as large as the face, black cells a little over it."""
    black = np.argwhere(bits(number, box.cells))
    cell_m = box.marker_m / box.cells
    squares = (black[:, ::-1].astype(np.float64) - box.cells / 2) * cell_m
    whole = np.array([[-box.edge_m / 2, -box.edge_m / 2]], dtype=np.float64)
    body = pybullet.createMultiBody(
        baseVisualShapeIndex=_quads(client, box, face, whole, box.edge_m, 1, _WHITE),
        linkMasses=[0],
        linkCollisionShapeIndices=[-1],
        linkVisualShapeIndices=[_quads(client, box, face, squares, cell_m, 2, _BLACK)],
        linkPositions=[(0, 0, 0)],
        linkOrientations=[(0, 0, 0, 1)],
        linkInertialFramePositions=[(0, 0, 0)],
        linkInertialFrameOrientations=[(0, 0, 0, 1)],
        linkParentIndices=[0],
        linkJointTypes=[pybullet.JOINT_FIXED],
        linkJointAxis=[(0, 0, 1)],
        physicsClientId=client,
    )
    return int(body)


def _quads(
    client: int, box: MarkerBox, face: str, low_m: Array, edge_m: float, layer: int, colour: Colour
) -> int:
    """Squares of `edge_m` with these upper left corners (n, 2) on a face, as one mesh seen from outside."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * edge_m
    plan = (low_m[:, None, :] + square).reshape(-1, 2)
    normal = on_face(box, face, np.zeros((1, 2)), 1.0)[0] - on_face(box, face, np.zeros((1, 2)))[0]
    first = 4 * np.arange(len(low_m))[:, None]
    return int(
        pybullet.createVisualShape(
            pybullet.GEOM_MESH,
            vertices=on_face(box, face, plan, layer * _LIFT_M).tolist(),
            indices=(first + np.array([0, 2, 1, 0, 3, 2])).ravel().tolist(),
            normals=[normal.tolist()] * len(plan),
            uvs=[[0.0, 0.0]] * len(plan),
            rgbaColor=colour,
            physicsClientId=client,
        )
    )
