"""The rover as a Bullet multibody: chassis, two belt shoes on three joints each, arm and cabin.

PyBullet cannot give a contact surface a velocity. So each track is a shoe that stands still on the ground
while its joints carry the chassis over it: along x (belt travel), along y (drift on cross slopes) and about z
(turning). Where the shoe has moved a little way it is put back under the chassis. The contacts stay static,
hence the rover neither creeps on slopes nor scrubs in turns, and what it cannot push slides by Coulomb's law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.rig import RigCalibration
from executive.types import Array, Quat, Vec3
from sim_pybullet.bullet import pybullet
from sim_pybullet.shape import ARM_THICKNESS_M, Belt, arm, belt, cabin, chassis

YAW, SIDE, BELT = 0, 1, 2  # joints of a track, from the chassis outwards
TRACK_JOINTS = (0, 3)  # first joint of the left and the right track
SHOES = (2, 5)
ARM_JOINT, CABIN_JOINT = 6, 7
CHASSIS_LINK = -1

TRACK_MASS_KG = 0.30
ARM_MASS_KG = 0.10
CARRIER_MASS_KG = 0.01  # links between chassis and shoe; Bullet needs some mass to move them
SHOE_FORCE_N = 60.0
# Weak on purpose: on rough ground the two tracks go paths of different length, and the chassis must be
# free to turn on its shoes by that, else they pull against each other up to sliding. Measured: below 0.1
# the shoes wander on cross slopes, above 1 the paths differ between time scales.
SHOE_TORQUE_NM = 0.25
CABIN_TORQUE_NM = 20.0
REBASE_M = 0.0005
REBASE_RAD = math.radians(0.2)
BELLY_FRICTION = 0.5
SOLE_M = 0.002  # by how much the sole stands out from the end cylinders
BOX_LIFT_M = 0.012
GAINS = {"positionGain": 0.3, "velocityGain": 1.0}


@dataclass
class ShoeSetpoint:
    """Where a shoe's joints should be relative to the chassis: about z [rad], along y and x [m]."""

    yaw_rad: float = 0.0
    side_m: float = 0.0
    belt_m: float = 0.0

    def values(self) -> tuple[float, float, float]:
        return self.yaw_rad, self.side_m, self.belt_m


@dataclass(frozen=True)
class TrackMotion:
    """How fast one shoe moves against the chassis in physics time: about z [rad/s], along y and x [m/s]."""

    yaw_rad_s: float = 0.0
    side_m_s: float = 0.0
    belt_m_s: float = 0.0

    def values(self) -> tuple[float, float, float]:
        return self.yaw_rad_s, self.side_m_s, self.belt_m_s

    @property
    def still(self) -> bool:
        return self.yaw_rad_s == 0.0 and self.side_m_s == 0.0 and self.belt_m_s == 0.0


class RoverBody:
    """The multibody and its joints; poses in `site`. One belongs to one physics client."""

    def __init__(self, client: int, rig: RigCalibration, position_site_m: Vec3, quat_site_body: Quat) -> None:
        self.client, self.rig = client, rig
        self._chassis_z_m = chassis(rig.rover).centre_m[2]
        self._setpoints = (ShoeSetpoint(), ShoeSetpoint())
        self._friction = [0.0, 0.0]
        self.id = _build(client, rig, self._chassis_position(position_site_m, quat_site_body), quat_site_body)
        pybullet.changeDynamics(self.id, -1, linearDamping=0.0, angularDamping=0.0, physicsClientId=client)
        pybullet.changeDynamics(self.id, -1, lateralFriction=BELLY_FRICTION, physicsClientId=client)
        for side in (0, 1):
            self.set_friction(side, 0.8)
        self.hold_cabin(0.0, 0.0)
        self.command((TrackMotion(), TrackMotion()))

    def _chassis_position(self, position_site_m: Vec3, quat_site_body: Quat) -> Vec3:
        up = np.array(pybullet.getMatrixFromQuaternion(quat_site_body)).reshape(3, 3)[:, 2]
        x, y, z = np.array(position_site_m) + self._chassis_z_m * up
        return float(x), float(y), float(z)

    def set_friction(self, side: int, friction: float) -> None:
        """Coulomb friction of one track on the ground; does nothing if it has that value."""
        if abs(friction - self._friction[side]) < 1e-6:
            return
        # Alone in its call: beside damping arguments Bullet would put it on the base, silently.
        pybullet.changeDynamics(self.id, SHOES[side], lateralFriction=friction, physicsClientId=self.client)
        self._friction[side] = friction

    def friction(self, side: int) -> float:
        """What Bullet itself holds as one track's friction."""
        return float(pybullet.getDynamicsInfo(self.id, SHOES[side], physicsClientId=self.client)[1])

    def command(self, motions: tuple[TrackMotion, TrackMotion], step_s: float = 0.0) -> None:
        """Advance both shoes' setpoints by `step_s` at these rates and drive the joints there."""
        joints: list[int] = []
        targets: list[float] = []
        rates: list[float] = []
        for side, motion in enumerate(motions):
            setpoint = self._setpoints[side]
            setpoint.yaw_rad += motion.yaw_rad_s * step_s
            setpoint.side_m += motion.side_m_s * step_s
            setpoint.belt_m += motion.belt_m_s * step_s
            if step_s > 0.0:
                self._rebase(side)
            joints += [TRACK_JOINTS[side] + k for k in (YAW, SIDE, BELT)]
            targets += setpoint.values()
            rates += motion.values()
        pybullet.setJointMotorControlArray(
            self.id,
            joints,
            pybullet.POSITION_CONTROL,
            targetPositions=targets,
            targetVelocities=rates,
            forces=[SHOE_TORQUE_NM, SHOE_FORCE_N, SHOE_FORCE_N] * 2,
            positionGains=[GAINS["positionGain"]] * 6,
            velocityGains=[GAINS["velocityGain"]] * 6,
            physicsClientId=self.client,
        )

    def _rebase(self, side: int) -> None:
        """Put the shoe back under the chassis where it has gone too far, keeping the lag along x and y."""
        setpoint = self._setpoints[side]
        first = TRACK_JOINTS[side]
        if abs(setpoint.side_m) >= REBASE_M:
            self._shift_joint(first + SIDE, setpoint.side_m)
            setpoint.side_m = 0.0
        if abs(setpoint.belt_m) >= REBASE_M:
            self._shift_joint(first + BELT, setpoint.belt_m)
            setpoint.belt_m = 0.0
        angle = pybullet.getJointState(self.id, first + YAW, physicsClientId=self.client)[0]
        if abs(angle) >= REBASE_RAD:
            self._shift_joint(first + YAW, angle)
            setpoint.yaw_rad = 0.0

    def _shift_joint(self, joint: int, by: float) -> None:
        position, velocity = pybullet.getJointState(self.id, joint, physicsClientId=self.client)[:2]
        pybullet.resetJointState(self.id, joint, position - by, velocity, physicsClientId=self.client)

    def hold_cabin(self, arm_rad: float, cabin_rad: float) -> None:
        """Drive the arm and cabin joints to these angles."""
        # About +y: the arm turns by -arm, the cabin against the arm by arm - cabin (rig.CabinCalibration).
        for joint, angle in ((ARM_JOINT, -arm_rad), (CABIN_JOINT, arm_rad - cabin_rad)):
            pybullet.setJointMotorControl2(
                self.id,
                joint,
                pybullet.POSITION_CONTROL,
                targetPosition=angle,
                force=CABIN_TORQUE_NM,
                physicsClientId=self.client,
                **GAINS,
            )

    def cabin_angles(self) -> tuple[float, float]:
        """True angles of the arm and the cabin, as the rig defines them [rad]."""
        arm_joint, cabin_joint = (
            pybullet.getJointState(self.id, j, physicsClientId=self.client)[0]
            for j in (ARM_JOINT, CABIN_JOINT)
        )
        return -arm_joint, -arm_joint - cabin_joint

    def traction(self) -> tuple[float, float]:
        """What each belt pulls with: the friction on its shoe along the body's x, in the last step [N].

        Not the joint's force: a rock in front of a shoe would load that, but stands against the housing.
        """
        ahead = self.pose()[1][:, 0].tolist()
        left, right = (self._friction_along(ahead, shoe) for shoe in SHOES)
        return left, right

    def _friction_along(self, axis_site: list[float], link: int) -> float:
        contacts = pybullet.getContactPoints(bodyA=self.id, linkIndexA=link, physicsClientId=self.client)
        along = (
            c[10] * sum(a * b for a, b in zip(axis_site, c[11], strict=True))
            + c[12] * sum(a * b for a, b in zip(axis_site, c[13], strict=True))
            for c in contacts
        )
        return float(sum(along))

    def pose(self) -> tuple[Array, Array]:
        """Position (3,) and rotation (3, 3) of `body` in `site`."""
        position, quat = pybullet.getBasePositionAndOrientation(self.id, physicsClientId=self.client)
        rotation = np.array(pybullet.getMatrixFromQuaternion(quat)).reshape(3, 3)
        return np.array(position) - self._chassis_z_m * rotation[:, 2], rotation

    def quat(self) -> Quat:
        """quat_site_body (x, y, z, w)."""
        x, y, z, w = pybullet.getBasePositionAndOrientation(self.id, physicsClientId=self.client)[1]
        return x, y, z, w

    def speed(self) -> tuple[float, float]:
        """Linear [m/s] and angular [rad/s] speed of the chassis, in physics time."""
        linear, angular = pybullet.getBaseVelocity(self.id, physicsClientId=self.client)
        return math.hypot(*linear), math.hypot(*angular)

    def link_pose(self, link: int) -> tuple[Vec3, Quat]:
        """Frame of a link in `site`, from Bullet itself."""
        state = pybullet.getLinkState(
            self.id, link, computeForwardKinematics=True, physicsClientId=self.client
        )
        return state[4], state[5]

    def push(self, force_site_n: Vec3, at_site_m: Array) -> None:
        """A force on the chassis during the next step."""
        pybullet.applyExternalForce(
            self.id,
            CHASSIS_LINK,
            force_site_n,
            at_site_m.tolist(),
            pybullet.WORLD_FRAME,
            physicsClientId=self.client,
        )


def _build(client: int, rig: RigCalibration, chassis_site_m: Vec3, quat_site_body: Quat) -> int:
    body = chassis(rig.rover)
    chassis_mass_kg = rig.rover.rover_mass_kg - 2 * TRACK_MASS_KG - ARM_MASS_KG - 4 * CARRIER_MASS_KG
    shoe = _shoe_shape(client, belt(rig.rover))
    cabin_box = cabin(rig)
    pivot, base = rig.cabin.arm_pivot_body_m, body.centre_m
    arm_at = (pivot[0] - base[0], pivot[1] - base[1], pivot[2] - base[2])
    z_shoe = belt(rig.rover).radius_m - base[2]
    half_gauge = rig.rover.track_gauge_m / 2
    prismatic, revolute = pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE
    zero = (0.0, 0.0, 0.0)
    links: list[
        tuple[float, int, Vec3, Vec3, int, int, Vec3]
    ] = []  # mass, shape, at, inertial, parent, type, axis
    for first, side in zip(TRACK_JOINTS, (1.0, -1.0), strict=True):
        at = (0.0, side * half_gauge, z_shoe)
        links += [
            (CARRIER_MASS_KG, -1, at, zero, 0, revolute, (0.0, 0.0, 1.0)),
            (CARRIER_MASS_KG, -1, zero, zero, first + 1, prismatic, (0.0, 1.0, 0.0)),
            (TRACK_MASS_KG, shoe, zero, zero, first + 2, prismatic, (1.0, 0.0, 0.0)),
        ]
    length_m = rig.cabin.arm_length_m
    arm_shape = _box_shape(client, (length_m, arm(rig).size_m[1], ARM_THICKNESS_M), (length_m / 2, 0.0, 0.0))
    cabin_shape = _box_shape(client, cabin_box.size_m, cabin_box.centre_m)
    links += [
        (ARM_MASS_KG, arm_shape, arm_at, (length_m / 2, 0.0, 0.0), 0, revolute, (0.0, 1.0, 0.0)),
        (
            rig.rover.payload_mass_kg,
            cabin_shape,
            (length_m, 0.0, 0.0),
            cabin_box.centre_m,
            ARM_JOINT + 1,
            revolute,
            (0.0, 1.0, 0.0),
        ),
    ]
    masses, shapes, positions, inertials, parents, types, axes = (
        list(column) for column in zip(*links, strict=True)
    )
    n = len(links)
    level = (0.0, 0.0, 0.0, 1.0)
    return int(
        pybullet.createMultiBody(
            baseMass=chassis_mass_kg,
            baseCollisionShapeIndex=_box_shape(client, body.size_m, zero),
            basePosition=chassis_site_m,
            baseOrientation=quat_site_body,
            linkMasses=masses,
            linkCollisionShapeIndices=shapes,
            linkVisualShapeIndices=[-1] * n,
            linkPositions=positions,
            linkOrientations=[level] * n,
            linkInertialFramePositions=inertials,
            linkInertialFrameOrientations=[level] * n,
            linkParentIndices=parents,
            linkJointTypes=types,
            linkJointAxis=axes,
            physicsClientId=client,
        )
    )


def _box_shape(client: int, size_m: Vec3, centre_m: Vec3) -> int:
    return int(
        pybullet.createCollisionShape(
            pybullet.GEOM_BOX,
            halfExtents=[edge / 2 for edge in size_m],
            collisionFramePosition=centre_m,
            physicsClientId=client,
        )
    )


def _shoe_shape(client: int, b: Belt) -> int:
    """A track from primitives: convex hulls cost five to ten times as much on a heightfield.

    It stands on a capsule along x, which is round all over: the lower edge of a box would catch on the
    triangles of the ground. The end cylinders and the box, a little higher, meet rocks.
    """
    sole_m = b.width_m / 2
    along = pybullet.getQuaternionFromEuler([0.0, math.pi / 2, 0.0])
    across = pybullet.getQuaternionFromEuler([math.pi / 2, 0.0, 0.0])
    end_m, end_x_m = b.radius_m - SOLE_M, b.length_m / 2 - b.radius_m
    box_low_m = BOX_LIFT_M - b.radius_m
    box = [b.flat_m / 2, b.width_m / 2, (b.radius_m - box_low_m) / 2]
    return int(
        pybullet.createCollisionShapeArray(
            shapeTypes=[
                pybullet.GEOM_CAPSULE,
                pybullet.GEOM_CYLINDER,
                pybullet.GEOM_CYLINDER,
                pybullet.GEOM_BOX,
            ],
            halfExtents=[[0.0] * 3, [0.0] * 3, [0.0] * 3, box],
            radii=[sole_m, end_m, end_m, 0.0],
            lengths=[b.length_m - 2 * sole_m, b.width_m, b.width_m, 0.0],
            collisionFramePositions=[
                [0.0, 0.0, sole_m - b.radius_m],
                [end_x_m, 0.0, 0.0],
                [-end_x_m, 0.0, 0.0],
                [0.0, 0.0, (b.radius_m + box_low_m) / 2],
            ],
            collisionFrameOrientations=[along, across, across, [0.0, 0.0, 0.0, 1.0]],
            physicsClientId=client,
        )
    )
