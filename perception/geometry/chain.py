"""The whole chain of projection: body pose, cabin joints, head angles -> marker pixels, with Jacobian.

The state has ten parts: body pose in `site` (position, rotation vector on the left: the order and the
meaning of PoseEstimate's covariance), then pan, tilt, arm, cabin. The last four are read from encoders
with known accuracy; as parts of the state their errors reach the covariance with all correlations.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Array, PoseEstimate, Vec2
from perception.geometry.body import Transform, kernel_cabin, plc_in_body
from perception.geometry.camera import StereoModel
from perception.geometry.head_model import kernel_head, site_ih
from perception.geometry.rotation import exp_map, matrix_from_quat, quat_from_matrix
from perception.kernels.chain import STATE_SIZE as STATE_SIZE
from perception.kernels.chain import CabinChain, HeadChain, project, project_points
from perception.kernels.compiled import plain
from perception.kernels.optics import Optics

_SIGMA_FLOOR_RAD = 1e-7  # an encoder said to be perfect must not make the normal equations infinite


@dataclass(frozen=True, eq=False)
class ChainState:
    """Body in site, head angles (pan, tilt), cabin joints (arm, cabin) [rad]."""

    site_body: Transform
    head_rad: Vec2
    joints_rad: Vec2

    @property
    def angles_rad(self) -> Array:
        """Pan, tilt, arm, cabin (4,)."""
        return np.array([*self.head_rad, *self.joints_rad])

    def moved(self, step: Array) -> ChainState:
        """This state changed by a step of ten (see the module's docstring)."""
        body = Transform(exp_map(step[3:6]) @ self.site_body.rotation, self.site_body.position_m + step[:3])
        head = (self.head_rad[0] + float(step[6]), self.head_rad[1] + float(step[7]))
        joints = (self.joints_rad[0] + float(step[8]), self.joints_rad[1] + float(step[9]))
        return ChainState(body, head, joints)


@dataclass(frozen=True, eq=False)
class Chain:
    """The rig as a function from state to pixels. `markers_plc_m` is (n, 3)."""

    rig: RigCalibration
    model: StereoModel
    markers_plc_m: Array

    @classmethod
    def of(cls, rig: RigCalibration) -> Chain:
        return cls(rig, StereoModel.of(rig), plain(rig.markers.positions_plc_m))

    @cached_property
    def kernel_rig(self) -> tuple[Optics, HeadChain, CabinChain, Array]:
        """What the kernels take of the rig."""
        return self.model.optics, kernel_head(self.rig.head), kernel_cabin(self.rig.cabin), self.markers_plc_m

    def site_ih(self, head_rad: Vec2) -> Transform:
        """Pose of the head in site (executive.core.rig.HeadCalibration)."""
        return site_ih(self.rig.head, head_rad)

    def site_plc(self, state: ChainState) -> Transform:
        """Pose of the marker plane in site."""
        return state.site_body @ plc_in_body(self.rig.cabin, *state.joints_rad)

    def markers_site(self, state: ChainState) -> Array:
        """Marker positions (n, 3) in site."""
        return self.site_plc(state).apply(self.markers_plc_m)

    def project(self, state: ChainState) -> tuple[Array, Array]:
        """Marker pixels (2, n, 2) and their Jacobian by the state (2, n, 2, 10)."""
        body = state.site_body
        place = plain(body.rotation), plain(body.position_m), state.angles_rad
        return project(*self.kernel_rig, *place)

    def project_points(
        self, points_site_m: Array, head_rad: Vec2, arms_site_m: Array, by_joints: Array
    ) -> tuple[Array, Array]:
        """Pixels and Jacobian of points (n, 3) in site, at arms (n, 3) from the body, by_joints (n, 3, 2)."""
        head = kernel_head(self.rig.head)
        of_body = plain(arms_site_m), plain(by_joints)
        return project_points(self.model.optics, head, plain(points_site_m), *head_rad, *of_body)

    def encoder_sigma_rad(self) -> Array:
        """Standard deviations of pan, tilt, arm, cabin; a uniform error of half-width a has a / sqrt(3)."""
        head, cabin = self.rig.head, self.rig.cabin
        uniform = np.array([head.pan_accuracy_rad, head.tilt_accuracy_rad]) / np.sqrt(3.0)
        sigma = np.concatenate([uniform, [cabin.joint_sigma_rad] * 2])
        return np.asarray(np.maximum(sigma, _SIGMA_FLOOR_RAD), dtype=np.float64)

    @cached_property
    def encoder_weight(self) -> Array:
        """Their inverse variances (4,)."""
        return self.encoder_sigma_rad() ** -2

    def state_covariance(self, pose_covariance: Array) -> Array:
        """Covariance (10, 10) of a state whose body pose has this (6, 6) one."""
        P = np.zeros((STATE_SIZE, STATE_SIZE))
        P[:6, :6] = pose_covariance
        P[6:, 6:] = np.diag(self.encoder_sigma_rad() ** 2)
        return P


def body_transform(pose: PoseEstimate) -> Transform:
    """Body in site of a pose estimate."""
    return Transform(matrix_from_quat(pose.quat_site_body), np.array(pose.position_site_m))


def pose_estimate(
    time_s: float, site_body: Transform, covariance: Array, source: str, markers: int = 0
) -> PoseEstimate:
    """The pose estimate of a body in site with its covariance (6, 6)."""
    x, y, z = site_body.position_m.tolist()
    quat = quat_from_matrix(site_body.rotation)
    return PoseEstimate(time_s, (x, y, z), quat, covariance, source, markers=markers)
