"""A rover on its way, seen twice by a head that vibrates: images of the full tier, of both cameras.

Rough ground, cast shadow, noise, any sun from 15 to 60 degrees of height. The head is off by its accuracy and
shaken by up to 3 px along both axes in each frame, the prediction off as it is on the way.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from executive.core.clock import Stopwatch
from executive.core.rig import RigCalibration
from executive.core.types import (
    HeadReading,
    Images,
    PoseEstimate,
    PoseSource,
    Shot,
)
from perception.frames.exposure import plate_view
from perception.geometry.body import Transform
from perception.geometry.chain import Chain
from perception.geometry.follow_up import pointing_at
from perception.geometry.pose import roll_pitch
from perception.geometry.prediction import Expectation, expect
from perception.geometry.roi import full_windows, predicted_windows
from perception.geometry.rotation import quat_from_matrix, rot_z
from perception.localizer.trend import CADENCE_S, LEDS, window_margin_px
from perception.outline.moving_rover import moving_rover
from sim_pybullet.picture import Picture
from sim_pybullet.procedural import Relief, make_ground
from sim_pybullet.sensor import Sensor
from sim_pybullet.sunlight import Sun
from sim_pybullet.terrain import Terrain
from tests.perception.passive_trials import scene, stand

RIG = RigCalibration()
STEP_M = 0.028  # 20 s at track speed
VIBRATION_PX = 3.0
SITES = 16
_OFF_M, _OFF_HEIGHT_M, _OFF_HEADING_RAD = 0.05, 0.02, np.radians(3.0)  # standard deviations


@dataclass(frozen=True)
class Setting:
    """What was drawn: where the rover was at both frames, what the executive knows, and the images."""

    before: Transform
    after: Transform
    chain: Chain
    expectation: Expectation
    predicted: PoseEstimate
    data: Images


@dataclass(frozen=True)
class Trial:
    """`error_m` and `step_error_m` (3,) along, across and up, their covariances (3, 3) alike; None if nothing
    was found. `seconds` is what both cameras' pairs took together."""

    error_m: np.ndarray | None
    covariance: np.ndarray | None
    step_error_m: np.ndarray | None
    step_covariance: np.ndarray | None
    seconds: float


@lru_cache(maxsize=SITES)
def site(index: int) -> tuple[Terrain, Picture]:
    """One of some grounds, each under a sun of its own."""
    draws = np.random.default_rng([78, index])
    terrain = make_ground(Relief(0.008), (-2.0, -14.0), 28.0, 0.05, draws)
    sun = Sun(np.radians(draws.uniform(15, 60)), draws.uniform(-np.pi, np.pi))
    return terrain, Picture(RIG, terrain, sun, draws)


def draw(range_m: float, rng: np.random.Generator, step_m: float = STEP_M, sites: int = SITES) -> Setting:
    """A rover at about `range_m` on its way from the head, within 30 degrees; two frames taken."""
    terrain, picture = site(int(rng.integers(sites)))
    chain = Chain.of(RIG)
    distance, bearing = np.sqrt(range_m**2 - 1.4**2), rng.uniform(-0.6, 0.6)
    heading = bearing + rng.uniform(-0.5, 0.5)
    end = distance * np.array([np.cos(bearing), np.sin(bearing)])
    course = heading + 0.05 * rng.standard_normal()
    start = end - step_m * np.array([np.cos(course), np.sin(course)])
    before, after = stand(terrain, *start, heading), stand(terrain, *end, heading)
    expectation, predicted = _expected(chain, after, rng)
    margin_px = window_margin_px(RIG, plate_view(chain, expectation.state).range_m)
    windows = predicted_windows(chain, expectation.state, expectation.covariance, margin_px)
    windows = windows or full_windows(chain)
    head = np.array(expectation.state.head_rad) + _accuracy() * rng.uniform(-1, 1, 2)
    joints = expectation.state.joints_rad
    sensor, stacks = Sensor(picture.exposure, rng), ([], [])
    for body in (before, after):
        shake = VIBRATION_PX / RIG.cameras[0].focal_px * rng.uniform(-1, 1, 2)
        state = scene(body, joints, tuple(head + shake))
        for camera, window in enumerate(windows):
            stacks[camera].append(sensor.expose(picture.unlit_e(state, camera, window), 1)[0])
        picture.forget()
    reading = HeadReading(CADENCE_S, *expectation.state.head_rad, moving=False)
    counts = (np.stack(stacks[0]), np.stack(stacks[1]))
    data = Images(2 * CADENCE_S, Shot(LEDS, windows, CADENCE_S), windows, counts, reading)
    return Setting(before, after, chain, expectation, predicted, data)


def _accuracy() -> np.ndarray:
    return np.array([RIG.head.pan_accuracy_rad, RIG.head.tilt_accuracy_rad])


def _expected(chain: Chain, body: Transform, rng: np.random.Generator) -> tuple[Expectation, PoseEstimate]:
    off = np.append(_OFF_M * rng.standard_normal(2), _OFF_HEIGHT_M * rng.standard_normal())
    turned = rot_z(_OFF_HEADING_RAD * rng.standard_normal()) @ body.rotation
    x, y, z = body.position_m + off
    sigma = [_OFF_M, _OFF_M, _OFF_HEIGHT_M, 0.01, 0.01, _OFF_HEADING_RAD]
    predicted = PoseEstimate(
        0.0,
        (float(x), float(y), float(z)),
        quat_from_matrix(turned),
        np.diag(np.square(sigma)),
        PoseSource.PREDICTION,
    )
    raised = float(rng.choice([0.0, 0.5, 1.0]))
    roll, pitch = roll_pitch(body.rotation)[0] + RIG.rover.inclinometer_sigma_rad * rng.standard_normal(2)
    head = pointing_at(chain, np.add(predicted.position_site_m, [0, 0, 0.1]))
    return expect(chain, predicted, head, (raised, raised), (float(roll), float(pitch))), predicted


def run_trial(range_m: float, rng: np.random.Generator) -> Trial:
    """Draw, take two frames, look for what moved."""
    return judge(draw(range_m, rng))


def judge(s: Setting, repeats: int = 3) -> Trial:
    """What is made of a setting's frames, against the truth; the time is the shortest of some repeats."""
    range_m = plate_view(s.chain, s.expectation.state).range_m
    seconds = []
    for _ in range(repeats):
        watch = Stopwatch()
        found = moving_rover(s.chain, s.expectation, s.data, range_m)
        seconds.append(watch.elapsed_s())
    if found is None:
        return Trial(None, None, None, None, min(seconds))
    ahead = s.after.position_m[:2] / np.linalg.norm(s.after.position_m[:2])
    axes = np.eye(3)
    axes[:2, :2] = [ahead, [-ahead[1], ahead[0]]]
    step = s.after.position_m - s.before.position_m
    return Trial(
        error_m=axes @ (found.position_m - s.after.position_m),
        covariance=axes @ found.covariance @ axes.T,
        step_error_m=axes @ (found.step_m - step),
        step_covariance=axes @ found.step_covariance @ axes.T,
        seconds=min(seconds),
    )
