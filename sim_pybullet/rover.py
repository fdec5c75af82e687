"""The rover as a Bullet multibody: it lies free on the ground, and its tracks hold and carry it in the plane.

Bullet's contacts bear it (height, roll, pitch, rocks, a grounded belly). What the tracks do in the plane is a
servo along x, y and about z that can push no harder than the tracks grip: Coulomb's law with an anchor. So it
neither creeps at rest nor scrubs in turns, and where it cannot push, the anchor slips.

Two other ways were measured and left. Wheels creep on slopes. Shoes standing still on the ground, carrying
the chassis over it, hold on a plane; but on rough ground such contacts are statically indeterminate, their
inner forces grow up to sliding, and the rover walks about and believes itself blocked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.ordered_sum import ordered_sum
from executive.core.rig import RigCalibration
from executive.core.types import Array, Quat, Vec3
from sim_pybullet.bullet import pybullet
from sim_pybullet.shape import Belt, arm, belt, cabin, chassis

X, Y, YAW, Z, PITCH, ROLL = range(6)  # the joints from the site to the body, in this order
BODY_LINK, LEFT_SHOE, RIGHT_SHOE, ARM_LINK, CABIN_LINK = ROLL, 6, 7, 8, 9
PLANE = (X, Y, YAW)
FREE = (Z, PITCH, ROLL)
SHOES = (LEFT_SHOE, RIGHT_SHOE)

TRACK_MASS_KG = 0.30
ARM_MASS_KG = 0.10
CARRIER_MASS_KG = 0.002  # links between site and body; Bullet needs some mass to move them
CABIN_TORQUE_NM = 20.0
# How far the body may be from its anchor [m, m, rad]; further, and the tracks have slipped.
LONGEST_LAG = (0.0005, 0.0005, math.radians(0.2))
TILT_DAMPING = 0.3  # [N m s] of roll and pitch: soil swallows what would rock for long
BELLY_FRICTION = 0.5
SOLE_M = 0.002  # by how much a shoe's sole stands out from its end cylinders
BOX_LIFT_M = 0.012
GAINS = {"positionGain": 0.3, "velocityGain": 1.0}


@dataclass(frozen=True)
class PlaneRate:
    """How the anchor moves in physics time, in `site`: along x and y [m/s], about z [rad/s]."""

    x_m_s: float = 0.0
    y_m_s: float = 0.0
    yaw_rad_s: float = 0.0

    def values(self) -> tuple[float, float, float]:
        return self.x_m_s, self.y_m_s, self.yaw_rad_s


@dataclass(frozen=True)
class Grip:
    """What both tracks together can push with: in any direction of the plane [N], about z [N m]."""

    force_n: float
    torque_nm: float


class RoverBody:
    """The multibody and its joints; poses in `site`. One belongs to one physics client."""

    def __init__(self, client: int, rig: RigCalibration, position_site_m: Vec3, quat_site_body: Quat) -> None:
        self.client, self.rig = client, rig
        self.id = _build(client, rig)
        self._friction()
        yaw, pitch, roll = Rotation.from_quat(quat_site_body).as_euler("ZYX")
        x, y, z = position_site_m
        for joint, value in zip((X, Y, YAW, Z, PITCH, ROLL), (x, y, yaw, z, pitch, roll), strict=True):
            pybullet.resetJointState(self.id, joint, float(value), physicsClientId=client)
        self._anchor = [x, y, float(yaw)]
        self._force_site = (0.0, 0.0, 0.0)
        self.hold_cabin(0.0, 0.0)

    def _friction(self) -> None:
        for link in range(pybullet.getNumJoints(self.id, physicsClientId=self.client)):
            # Alone in its call: beside damping arguments Bullet would put it on the base, silently.
            friction = 0.0 if link in SHOES else BELLY_FRICTION
            pybullet.changeDynamics(self.id, link, lateralFriction=friction, physicsClientId=self.client)
        for joint in FREE:
            damping = TILT_DAMPING if joint != Z else 0.0
            pybullet.changeDynamics(self.id, joint, jointDamping=damping, physicsClientId=self.client)
            pybullet.setJointMotorControl2(
                self.id, joint, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=self.client
            )

    def command(self, rate: PlaneRate, grip: Grip, step_s: float) -> None:
        """Move the anchor on by one step and drive the body there, no harder than the tracks grip."""
        states = pybullet.getJointStates(self.id, PLANE, physicsClientId=self.client)
        for k, (state, lag) in enumerate(zip(states, LONGEST_LAG, strict=True)):
            self._anchor[k] = state[0] + min(lag, max(-lag, self._anchor[k] - state[0]))
        self._force_site = (float(states[0][3]), float(states[1][3]), float(states[2][3]))
        pybullet.setJointMotorControlArray(
            self.id,
            PLANE,
            pybullet.POSITION_CONTROL,
            targetPositions=self._anchor,
            targetVelocities=rate.values(),
            forces=self._limits(grip),
            positionGains=[GAINS["positionGain"]] * 3,
            velocityGains=[GAINS["velocityGain"]] * 3,
            physicsClientId=self.client,
        )
        for k, speed in enumerate(rate.values()):
            self._anchor[k] += speed * step_s

    def _limits(self, grip: Grip) -> tuple[float, float, float]:
        """The grip as limits of the three servos.

        Far from it they do not matter. Near it they must shrink together: pushes along x and y make a circle,
        and what the tracks spend on turning they lack for pushing (each has its own share of the grip).
        """
        fx, fy, torque_nm = (abs(f) for f in self._force_site)
        force_n = math.hypot(fx, fy)
        spent = force_n / grip.force_n + torque_nm / grip.torque_nm
        if spent < 0.9:
            return grip.force_n, grip.force_n, grip.torque_nm
        free = 0.05  # of the grip, left to each so that it can come back
        return (
            max(free * grip.force_n, fx / spent),
            max(free * grip.force_n, fy / spent),
            max(free * grip.torque_nm, torque_nm / spent),
        )

    def traction(self) -> tuple[float, float]:
        """What the left and the right belt push with along the ground, forward positive [N]."""
        fx, fy, torque_nm = (
            float(s[3]) for s in pybullet.getJointStates(self.id, PLANE, physicsClientId=self.client)
        )
        ahead = self.pose()[1][:2, 0]  # its length is the cosine of the pitch: servos push horizontally
        ahead_n = fx * float(ahead[0]) + fy * float(ahead[1])
        turning_n = torque_nm / self.rig.rover.track_gauge_m
        return ahead_n / 2 - turning_n, ahead_n / 2 + turning_n

    def loads(self) -> tuple[float, float]:
        """What presses the soles of the left and the right shoe on ground and rocks [N].

        A rock in front of a shoe does not press its sole.
        """
        up = self.pose()[1][:, 2].tolist()
        left, right = (self._pressed(shoe, up) for shoe in SHOES)
        return left, right

    def _pressed(self, shoe: int, up_site: list[float]) -> float:
        contacts = pybullet.getContactPoints(bodyA=self.id, linkIndexA=shoe, physicsClientId=self.client)
        return ordered_sum(
            float(c[9]) * max(0.0, ordered_sum(n * u for n, u in zip(c[7], up_site, strict=True)))
            for c in contacts
        )

    def hold_cabin(self, arm_rad: float, cabin_rad: float) -> None:
        """Drive the arm and cabin joints to these angles."""
        # About +y: the arm turns by -arm, the cabin against the arm by arm - cabin (rig.CabinCalibration).
        for joint, angle in ((ARM_LINK, -arm_rad), (CABIN_LINK, arm_rad - cabin_rad)):
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
        arm_state, cabin_state = pybullet.getJointStates(
            self.id, (ARM_LINK, CABIN_LINK), physicsClientId=self.client
        )
        return -float(arm_state[0]), -float(arm_state[0]) - float(cabin_state[0])

    def pose(self) -> tuple[Array, Array]:
        """Position (3,) and rotation (3, 3) of `body` in `site`."""
        position, quat = self.link_pose(BODY_LINK)
        return np.array(position), np.array(pybullet.getMatrixFromQuaternion(quat)).reshape(3, 3)

    def quat(self) -> Quat:
        """quat_site_body (x, y, z, w)."""
        return self.link_pose(BODY_LINK)[1]

    def speeds(self) -> tuple[float, float]:
        """Fastest of the body's joints along [m/s] and about [rad/s] an axis, in physics time."""
        rates = [
            abs(float(s[1])) for s in pybullet.getJointStates(self.id, range(6), physicsClientId=self.client)
        ]
        return max(rates[X], rates[Y], rates[Z]), max(rates[YAW], rates[PITCH], rates[ROLL])

    def link_pose(self, link: int) -> tuple[Vec3, Quat]:
        """Frame of a link in `site`, from Bullet itself."""
        state = pybullet.getLinkState(
            self.id, link, computeForwardKinematics=True, physicsClientId=self.client
        )
        return state[4], state[5]

    def push(self, force_site_n: Vec3, at_site_m: Array) -> None:
        """A force on the body during the next step."""
        pybullet.applyExternalForce(
            self.id,
            BODY_LINK,
            force_site_n,
            at_site_m.tolist(),
            pybullet.WORLD_FRAME,
            physicsClientId=self.client,
        )


@dataclass(frozen=True)
class _Link:
    """One link of the chain: `inertial` is its centre of mass and `at` its joint, in the parent's frame."""

    parent: int
    joint: int
    axis: Vec3 = (0.0, 0.0, 1.0)
    mass_kg: float = CARRIER_MASS_KG
    shape: int = -1
    at: Vec3 = (0.0, 0.0, 0.0)
    inertial: Vec3 = (0.0, 0.0, 0.0)


def _links(client: int, rig: RigCalibration) -> tuple[_Link, ...]:
    body, top, track = chassis(rig), cabin(rig), belt(rig)
    body_kg = rig.rover.rover_mass_kg - 2 * TRACK_MASS_KG - ARM_MASS_KG - 5 * CARRIER_MASS_KG
    slide, turn, fixed = pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE, pybullet.JOINT_FIXED
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    half_arm = (rig.cabin.arm_length_m / 2, 0.0, 0.0)
    arm_shape = _box_shape(client, arm(rig).size_m, half_arm)
    shoe = _shoe_shape(client, track)
    sides = (rig.rover.track_gauge_m / 2, -rig.rover.track_gauge_m / 2)
    return (
        _Link(-1, slide, x),
        _Link(X, slide, y),
        _Link(Y, turn, z),
        _Link(YAW, slide, z),
        _Link(Z, turn, y),
        _Link(
            PITCH, turn, x, body_kg, _box_shape(client, body.size_m, body.centre_m), inertial=body.centre_m
        ),
        *(_Link(ROLL, fixed, z, TRACK_MASS_KG, shoe, (0.0, s, track.radius_m)) for s in sides),
        _Link(ROLL, turn, y, ARM_MASS_KG, arm_shape, rig.cabin.arm_pivot_body_m, half_arm),
        _Link(
            ARM_LINK,
            turn,
            y,
            rig.rover.payload_mass_kg,
            _box_shape(client, top.size_m, top.centre_m),
            (rig.cabin.arm_length_m, 0.0, 0.0),
            top.centre_m,
        ),
    )


def _build(client: int, rig: RigCalibration) -> int:
    links = _links(client, rig)
    level = [(0.0, 0.0, 0.0, 1.0)] * len(links)
    return int(
        pybullet.createMultiBody(
            baseMass=0.0,  # the site itself
            linkMasses=[k.mass_kg for k in links],
            linkCollisionShapeIndices=[k.shape for k in links],
            linkVisualShapeIndices=[-1] * len(links),
            linkPositions=[k.at for k in links],
            linkOrientations=level,
            linkInertialFramePositions=[k.inertial for k in links],
            linkInertialFrameOrientations=level,
            linkParentIndices=[k.parent + 1 for k in links],  # Bullet counts the base as 0 here
            linkJointTypes=[k.joint for k in links],
            linkJointAxis=[k.axis for k in links],
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
