"""The husky in PyBullet: a body on four wheels that is moved as the ground lets its wheels move it.

Bullet's friction of four skidding cylinders jumps from edge to edge: on the spot, the same wheels turned the
robot by a fifth or by two thirds of what they should. So the motion in the plane is given, step by step, from
a model of the ground (`ground.py`); Bullet keeps the robot upon it, and turns the wheels.
"""

from __future__ import annotations

import math

import numpy as np

from yard_robot.bullet import HUSKY, pybullet, quiet
from yard_robot.marker_box import Array
from yard_robot.rig import Husky, Vec3

LEFT_WHEELS, RIGHT_WHEELS = (2, 4), (3, 5)
MOTOR_NM = 60.0
Quat = tuple[float, float, float, float]
Pair = tuple[float, float]


class HuskyBody:
    """The robot's body as Bullet moves it; how it looks is drawn elsewhere (`model.py`)."""

    def __init__(self, client: int, husky: Husky, at_m: Pair, heading_rad: float) -> None:
        self._client, self._husky = client, husky
        attitude = pybullet.getQuaternionFromEuler((0.0, 0.0, heading_rad))
        with quiet():  # the model has links without inertia, which Bullet complains of one by one
            self._id = pybullet.loadURDF(HUSKY, (*at_m, 0.0), attitude, physicsClientId=client)
        for wheel in (*LEFT_WHEELS, *RIGHT_WHEELS):
            pybullet.changeDynamics(self._id, wheel, lateralFriction=0.0, physicsClientId=client)

    def pose(self) -> tuple[Array, Array]:
        """Position (3,) and rotation matrix (3, 3) of `body` in `site`."""
        position, quat = self.placed()
        return np.array(position), np.array(pybullet.getMatrixFromQuaternion(quat)).reshape(3, 3)

    def placed(self) -> tuple[Vec3, Quat]:
        """Position and attitude (x, y, z, w) of `body` in `site`."""
        position, quat = pybullet.getBasePositionAndOrientation(self._id, physicsClientId=self._client)
        return position, quat

    def speed_m_s(self) -> float:
        """How fast it goes or falls."""
        return math.hypot(*pybullet.getBaseVelocity(self._id, physicsClientId=self._client)[0])

    def move(self, ahead_m_s: float, turn_rad_s: float, treads_m_s: Pair) -> None:
        """Make it go ahead and turn at these speeds in the next step, its treads at theirs."""
        linear, angular = pybullet.getBaseVelocity(self._id, physicsClientId=self._client)
        _, rotation = self.pose()
        x_m_s, y_m_s = (ahead_m_s * rotation[:2, 0]).tolist()
        pybullet.resetBaseVelocity(
            self._id,
            (x_m_s, y_m_s, linear[2]),
            (angular[0], angular[1], turn_rad_s),
            physicsClientId=self._client,
        )
        for wheels, speed_m_s in zip((LEFT_WHEELS, RIGHT_WHEELS), treads_m_s, strict=True):
            pybullet.setJointMotorControlArray(
                self._id,
                wheels,
                pybullet.VELOCITY_CONTROL,
                targetVelocities=[speed_m_s / self._husky.wheel_radius_m] * len(wheels),
                forces=[MOTOR_NM] * len(wheels),
                physicsClientId=self._client,
            )
