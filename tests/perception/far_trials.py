"""One localisation far away, from whole synthetic windows: truth drawn, frames streamed, bound for the same.

Everything that errs is drawn anew in each trial as the rig's calibration says: head, joints, inclinometers,
the height of the ground; the prediction is off by up to 150 mm and 10 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from executive.core.clock import Stopwatch
from executive.core.rig import RigCalibration
from executive.core.types import (
    HeadReading,
    Images,
    PoseEstimate,
    PoseSource,
    Shot,
    Window,
)
from perception.frames.codes import coded_sequence, lit
from perception.frames.difference import led_sequence, pair_weights
from perception.frames.exposure import SNR_WANTED, filter_snr_per_pair, plate_view
from perception.frames.psf import marker_spread
from perception.frames.vibration import shaken
from perception.geometry.body import Transform
from perception.geometry.chain import Chain, ChainState
from perception.geometry.follow_up import pointing_at
from perception.geometry.pose import PoseFit, roll_pitch
from perception.geometry.prediction import Expectation, expect
from perception.geometry.roi import predicted_windows
from perception.geometry.rotation import (
    log_map,
    quat_from_matrix,
    rot_x,
    rot_y,
    rot_z,
)
from perception.markers.fisher import centre_bound, pose_bound
from perception.markers.marker_fix import Rejection, with_note
from perception.markers.plausibility import choose
from perception.markers.shot_stack import ShotStack
from perception.markers.single import find_candidates
from tests.perception.synthetic import GAIN_E, Scene, noise_counts, observed
from tests.perception.trial_camera import Disturbance, Nuisance, Stage, TrialCamera, flux_e

OFF_M, OFF_RAD = 0.150, np.radians(10.0)
GROUND_SIGMA_M = 0.020  # what the prediction allows the ground; here the truth errs by as much
CHUNK = 64


@dataclass(frozen=True)
class Trial:
    """`error` (6,) of position [m] and rotation [rad] with its covariance, None if refused; the bound (6, 6);
    processing time."""

    error: np.ndarray | None
    covariance: np.ndarray | None
    bound: np.ndarray
    seconds: float
    why: str

    @property
    def detected(self) -> bool:
        return self.error is not None

    @property
    def false(self) -> bool:
        """Accepted, but x, y or yaw beyond 5 of its own sigmas."""
        if self.error is None or self.covariance is None:
            return False
        sigma = np.sqrt(np.diag(self.covariance))
        return bool((np.abs(self.error / sigma)[[0, 1, 5]] > 5).any())

    @property
    def nees(self) -> float:
        return float(self.error @ np.linalg.solve(self.covariance, self.error))


@dataclass(frozen=True)
class Setting:
    """A drawn truth, as encoders say it and as it is, and what is expected."""

    said: ChainState
    true: Scene
    expectation: Expectation
    tilt_rad: tuple[float, float]


def draw(
    range_m: float, rng: np.random.Generator, rig: RigCalibration, off: tuple[float, float] = (OFF_M, OFF_RAD)
) -> Setting:
    """A rover at about `range_m` that drove away from the head, cabin tilted to it as far as joints allow."""
    chain = Chain.of(rig)
    ground = np.sqrt(range_m**2 - 1.35**2)
    bearing = rng.uniform(-0.6, 0.6)
    heading = bearing + rng.uniform(-0.5, 0.5)
    roll, pitch = np.radians(2.0) * rng.standard_normal(2)
    z = GROUND_SIGMA_M * rng.standard_normal()
    position = np.array([ground * np.cos(bearing), ground * np.sin(bearing), z])
    body = Transform(rot_z(heading) @ rot_y(pitch) @ rot_x(roll), position)
    cabin = min(np.pi / 2 - np.arctan2(1.35, ground), rig.cabin.cabin_limits_rad[1])
    off_m, off_rad = off
    error = rng.uniform(-1, 1, 3) * [off_m, off_m, off_rad]
    predicted = PoseEstimate(
        0.0,
        (float(position[0] + error[0]), float(position[1] + error[1]), 0.0),
        quat_from_matrix(rot_z(error[2]) @ body.rotation),
        np.diag([off_m**2 / 3, off_m**2 / 3, 1e-12, 1e-4, 1e-4, off_rad**2 / 3]),
        PoseSource.PREDICTION,
    )
    head = pointing_at(chain, np.add(predicted.position_site_m, [0, 0, 0.12]))
    said = ChainState(body, head, (0.0, cabin))
    half = np.array([rig.head.pan_accuracy_rad, rig.head.tilt_accuracy_rad])
    true_head = tuple(np.array(head) + half * rng.uniform(-1, 1, 2))
    joints = tuple(np.array(said.joints_rad) + rig.cabin.joint_sigma_rad * rng.standard_normal(2))
    tilt = tuple(roll_pitch(body.rotation)[0] + rig.rover.inclinometer_sigma_rad * rng.standard_normal(2))
    true = observed(chain, ChainState(body, true_head, joints))
    return Setting(said, true, expect(chain, predicted, head, said.joints_rad, tilt), tilt)


def sequence_for(setting: Setting, pairs: int) -> tuple[tuple[int, ...], bool]:
    """The LED masks that the localizer would take for so many pairs, and whether it then detects jointly."""
    chain = setting.true.chain
    single = filter_snr_per_pair(chain.rig, plate_view(chain, setting.said)) * np.sqrt(pairs) >= SNR_WANTED
    if single or pairs < 4:
        return led_sequence(4, pairs), not single
    return coded_sequence(4, pairs), True


def run_trial(
    range_m: float,
    pairs: int,
    rng: np.random.Generator,
    rig: RigCalibration | None = None,
    nuisance: Nuisance | None = None,
    dark: bool = False,
    off: tuple[float, float] = (OFF_M, OFF_RAD),
    disturbance: Disturbance | None = None,
) -> Trial:
    """Draw, expose, localise; `dark` leaves the LEDs off, so that whatever is found is false.

    The prediction is `off` by up to so much [m], [rad]; a `disturbance` is drawn for this trial.
    """
    setting = draw(range_m, rng, rig or RigCalibration(), off)
    leds, joint = sequence_for(setting, pairs)
    stage = Stage(setting.true, windows_of(setting), leds)
    disturbance = disturbance or Disturbance()
    disturbance.begin(stage, rng)
    cameras = [TrialCamera.of(stage, c, rng, nuisance or Nuisance(), disturbance, dark) for c in (0, 1)]
    weights = _joint_weights(leds) if joint else np.linalg.norm(pair_weights(leds, 4), axis=1)
    limit = bound(setting, weights, GROUND_SIGMA_M if joint else np.inf)
    watch = Stopwatch()
    try:
        found, seconds = (_jointly if joint else _singly)(setting, cameras, stage, rng)
    except ValueError as refused:
        found, seconds = Rejection(str(refused), 0), watch.elapsed_s()
    fit = getattr(found, "fit", None)
    why = found.why if fit is None else setting.expectation.misfit(fit.state.site_body, fit.covariance)
    if why:
        return Trial(None, None, limit, seconds, why)
    return Trial(_error(setting.said.site_body, fit), fit.covariance, limit, seconds, "")


def windows_of(setting: Setting) -> tuple[Window, Window]:
    chain, expected = setting.true.chain, setting.expectation
    margin = marker_spread(chain.rig, plate_view(chain, expected.state).range_m).radius_px + 8.0
    windows = predicted_windows(chain, expected.state, expected.covariance, margin)
    assert windows is not None
    return windows


def _jointly(setting, cameras, stage, rng):
    """The joint answer and its processing time."""
    watch, unused = Stopwatch(), 0.0
    stack = ShotStack(setting.true.chain)
    for first in range(0, len(stage.leds), CHUNK):
        part = slice(first, first + CHUNK)
        before = watch.elapsed_s()
        counts = tuple(camera.expose(part, rng) for camera in cameras)
        unused += watch.elapsed_s() - before
        stack.add(_images(setting, stage, part, counts))
        if stack.problem:
            return Rejection(stack.problem, 0), watch.elapsed_s() - unused
    return stack.fix(setting.expectation, setting.tilt_rad, 1.0), watch.elapsed_s() - unused


def _singly(setting, cameras, stage, rng):
    """The same for markers found one by one."""
    chain, said = setting.true.chain, setting.said
    counts = tuple(camera.expose(slice(None), rng) for camera in cameras)
    watch = Stopwatch()
    images = _images(setting, stage, slice(None), counts)
    look = find_candidates(chain.rig, images, plate_view(chain, setting.expectation.state).range_m)
    if look.problem:
        return Rejection(look.problem, 0), watch.elapsed_s()
    prior = setting.expectation.prior
    chain = shaken(chain, look.unknown_px)
    found = choose(chain, look.candidates, said.head_rad, said.joints_rad, setting.tilt_rad, prior)
    return with_note(found, look.note), watch.elapsed_s()


def _images(setting, stage, part, counts) -> Images:
    """Frames of a part of the sequence as the cameras would return them."""
    head = HeadReading(0.0, *setting.said.head_rad, moving=False)
    return Images(0.0, Shot(stage.leds[part]), stage.windows, counts, head)


def _joint_weights(leds: tuple[int, ...]) -> np.ndarray:
    """The noise of each LED's difference image in frames' noises."""
    scatter = np.cov(lit(leds, 4).T, bias=True) * len(leds)
    return np.sqrt(np.diag(np.linalg.inv(scatter)))


def _error(true: Transform, fit: PoseFit) -> np.ndarray:
    body = fit.state.site_body
    return np.concatenate([true.position_m - body.position_m, log_map(true.rotation @ body.rotation.T)])


def bound(setting: Setting, weights: np.ndarray, height_sigma_m: float) -> np.ndarray:
    """The Cramer-Rao bound of the pose for the images that a trial makes."""
    scene = setting.true
    covariance = np.zeros((2, 4, 2, 2))
    for c in (0, 1):
        for m in range(4):
            spread = marker_spread(scene.chain.rig, float(scene.ranges_m[c, m]))
            off = scene.uv_px[c, m] - np.round(scene.uv_px[c, m])
            sigma = noise_counts() * float(weights[m])
            covariance[c, m] = centre_bound(spread, flux_e(scene, c, m) / GAIN_E, sigma, off)
    return pose_bound(scene.chain, scene.state, covariance, height_sigma_m=height_sigma_m)
