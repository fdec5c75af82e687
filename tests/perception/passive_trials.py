"""One passive localisation from images of the full tier: ground, rover, shadow and noise by the simulator.

Everything that errs is drawn anew in each trial as the rig's calibration says: head (once for the empty view,
once for that of the rover), joints, inclinometers, the surveyed height; the prediction is 150 mm and 10
degrees off. All LEDs are dead. What can be wrong is told by `Wrong`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np

from executive.core.clock import Stopwatch
from executive.core.rig import RigCalibration
from executive.core.types import PoseEstimate, PoseSource, Window
from perception.geometry.body import Transform
from perception.geometry.chain import Chain
from perception.geometry.follow_up import pointing_at
from perception.geometry.pose import roll_pitch
from perception.geometry.prediction import Expectation, expect
from perception.geometry.rotation import log_map, quat_from_matrix, rot_z
from perception.outline.passive import (
    Ground,
    PassiveFix,
    Sun,
    empty_window,
    passive_fix,
)
from sim_pybullet.picture import Picture
from sim_pybullet.procedural import Relief, make_ground
from sim_pybullet.projection import about_y
from sim_pybullet.scene import SceneState
from sim_pybullet.sensor import Sensor
from sim_pybullet.site import resting_height
from sim_pybullet.sunlight import Sun as TrueSun
from sim_pybullet.terrain import Terrain

RIG = RigCalibration()
OFF_M, OFF_RAD = 0.150, np.radians(10.0)
SURVEY_SIGMA_M = 0.003
SUN_SIGMA_RAD = np.radians(0.5)
FRAMES = 8
_SITES = 12


class Wrong(StrEnum):
    """What is not as the executive believes."""

    NOTHING = "nothing"
    BACKGROUND = "background"  # the empty view shows another place
    ELEVATION = "elevation"  # the surveyed height is 20 mm off


@dataclass(frozen=True)
class Trial:
    """`error` (6,) of position [m] and rotation [rad] in axes along, across, up; None if refused."""

    error: np.ndarray | None
    covariance: np.ndarray | None
    seconds: float
    why: str

    @property
    def false(self) -> bool:
        """Accepted, but along, across or yaw beyond 5 of its own sigmas."""
        if self.error is None or self.covariance is None:
            return False
        return bool((np.abs(self.error) / np.sqrt(np.diag(self.covariance)))[[0, 1, 5]].max() > 5)


@lru_cache(maxsize=_SITES)
def site(index: int) -> tuple[Terrain, Picture, TrueSun]:
    """One of a dozen grounds, each under a sun of its own."""
    draws = np.random.default_rng([77, index])
    terrain = make_ground(Relief(0.008), (-2.0, -14.0), 28.0, 0.05, draws)
    sun = TrueSun(np.radians(draws.uniform(20, 60)), draws.uniform(-np.pi, np.pi))
    return terrain, Picture(RIG, terrain, sun, draws), sun


def stand(terrain: Terrain, x: float, y: float, heading: float) -> Transform:
    """The rover at rest on the ground."""
    up = np.array(terrain.normal(x, y, RIG.rover.length_m))
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    ahead -= up * (ahead @ up)
    ahead /= np.linalg.norm(ahead)
    R = np.column_stack([ahead, np.cross(up, ahead), up])
    return Transform(R, np.array([x, y, resting_height(terrain, R, x, y, RIG)]))


def scene(body: Transform, joints: tuple[float, float], head: tuple[float, float]) -> SceneState:
    """What the simulator draws."""

    def homogeneous(R: np.ndarray, t: object) -> np.ndarray:
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, t
        return T

    c, (arm, cabin) = RIG.cabin, joints
    T_body = homogeneous(body.rotation, body.position_m)
    T_arm = T_body @ homogeneous(about_y(-arm), c.arm_pivot_body_m)
    T_cabin = T_arm @ homogeneous(about_y(arm - cabin), (c.arm_length_m, 0, 0))
    T_plc = T_cabin @ homogeneous(np.eye(3), c.plc_offset_cabin_m)
    return SceneState(0.0, T_body, T_arm, T_cabin, T_plc, arm, cabin, *head)


@dataclass(frozen=True)
class Setting:
    """What was drawn: the true body and all of its scene, what the executive knows, and the images of both
    cameras."""

    body: Transform
    terrain: Terrain
    scene: SceneState
    chain: Chain
    expectation: Expectation
    ground: Ground
    sun: Sun
    windows: tuple[Window, Window]
    images: list[np.ndarray]
    backgrounds: list[np.ndarray]


def draw(range_m: float, wrong: Wrong, rng: np.random.Generator) -> Setting:
    """A rover at about `range_m` that drove away from the head, plate tilted to it; images taken."""
    terrain, picture, true_sun = site(int(rng.integers(_SITES)))
    chain = Chain.of(RIG)
    distance = np.sqrt(range_m**2 - 1.4**2)
    bearing = rng.uniform(-0.6, 0.6)
    heading = bearing + rng.uniform(-0.5, 0.5)
    body = stand(terrain, distance * np.cos(bearing), distance * np.sin(bearing), heading)
    way = rng.uniform(-np.pi, np.pi)
    off = OFF_M * np.array([np.cos(way), np.sin(way)])
    turned = rng.choice([-1.0, 1.0]) * OFF_RAD
    x, y = body.position_m[:2] + off
    surveyed = body.position_m[2] + SURVEY_SIGMA_M * rng.standard_normal()
    surveyed += rng.choice([-0.02, 0.02]) * (wrong is Wrong.ELEVATION)
    predicted = PoseEstimate(
        0.0,
        (float(x), float(y), float(surveyed)),
        quat_from_matrix(rot_z(turned) @ body.rotation),
        np.diag([OFF_M**2 / 3, OFF_M**2 / 3, 1e-12, 1e-4, 1e-4, OFF_RAD**2 / 3]),
        PoseSource.PREDICTION,
    )
    said_head = pointing_at(chain, np.add(predicted.position_site_m, [0, 0, 0.1]))
    raised = float(rng.choice([0.0, 0.5, 1.0]))
    joints = (raised, raised)
    true_joints = tuple(np.array(joints) + RIG.cabin.joint_sigma_rad * rng.standard_normal(2))
    tilt = roll_pitch(body.rotation)[0] + RIG.rover.inclinometer_sigma_rad * rng.standard_normal(2)
    expectation = expect(chain, predicted, said_head, joints, (float(tilt[0]), float(tilt[1])))
    windows = empty_window(chain, expectation)
    truth = scene(body, true_joints, _head(said_head, rng))
    images = _expose(picture, truth, windows, rng)
    gone = Transform(np.eye(3), np.array([-500.0, 0.0, 0.0]))
    elsewhere = np.radians(rng.choice([-1, 1], 2) * rng.uniform(0.5, 2.0, 2)) * (wrong is Wrong.BACKGROUND)
    empty = scene(gone, true_joints, _head(np.add(said_head, elsewhere), rng))
    backgrounds = _expose(picture, empty, windows, rng)
    sun = Sun(
        true_sun.azimuth_rad + SUN_SIGMA_RAD * rng.standard_normal(),
        true_sun.elevation_rad + SUN_SIGMA_RAD * rng.standard_normal(),
    )
    ground = Ground(float(surveyed), SURVEY_SIGMA_M)
    return Setting(body, terrain, truth, chain, expectation, ground, sun, windows, images, backgrounds)


def _head(said: object, rng: np.random.Generator) -> tuple[float, float]:
    half = np.array([RIG.head.pan_accuracy_rad, RIG.head.tilt_accuracy_rad])
    pan, tilt = np.array(said) + half * rng.uniform(-1, 1, 2)
    return float(pan), float(tilt)


def _expose(picture: Picture, state: SceneState, windows, rng: np.random.Generator) -> list[np.ndarray]:
    sensor = Sensor(picture.exposure, rng)
    stacks = [sensor.expose(picture.unlit_e(state, c, w), FRAMES) for c, w in enumerate(windows)]
    picture.forget()
    return stacks


def run_trial(range_m: float, rng: np.random.Generator, wrong: Wrong = Wrong.NOTHING) -> Trial:
    """Draw, expose, localise."""
    s = draw(range_m, wrong, rng)
    watch = Stopwatch()
    found = passive_fix(s.chain, s.images, s.backgrounds, s.windows, s.expectation, s.ground, s.sun)
    seconds = watch.elapsed_s()
    if not isinstance(found, PassiveFix):
        return Trial(None, None, seconds, found.why)
    return judged(s, found.site_body, found.covariance, seconds)


def judged(setting: Setting, body: Transform, covariance: np.ndarray, seconds: float) -> Trial:
    """A pose against the truth."""
    true = setting.body
    error = np.concatenate([true.position_m - body.position_m, log_map(true.rotation @ body.rotation.T)])
    ahead = true.position_m[:2] / np.linalg.norm(true.position_m[:2])
    axes = np.eye(6)
    axes[:2, :2] = [ahead, [-ahead[1], ahead[0]]]
    return Trial(axes @ error, axes @ covariance @ axes.T, seconds, "")
