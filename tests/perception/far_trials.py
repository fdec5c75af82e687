"""One localisation far away, from whole synthetic windows: truth drawn, frames streamed, bound for the same.

Everything that errs is drawn anew in each trial as the rig's calibration says: head, joints, inclinometers,
the height of the ground; the prediction is off by up to 150 mm and 10 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from executive.clock import Stopwatch
from executive.rig import RigCalibration
from executive.types import HeadReading, Images, PoseEstimate, Shot, Source, Window
from perception.body import Transform
from perception.chain import Chain, ChainState
from perception.codes import coded_sequence, lit
from perception.difference import led_sequence, pair_weights
from perception.exposure import SNR_WANTED, filter_snr_per_pair, view_of
from perception.fisher import centre_bound, pose_bound
from perception.follow_up import pointing_at
from perception.joint import joint_fix
from perception.look import look_at
from perception.plausibility import choose
from perception.pose import Fix, roll_pitch
from perception.prediction import Expectation, expect
from perception.psf import marker_spread
from perception.roi import predicted_windows
from perception.rotation import log_map, quat_from_matrix, rot_x, rot_y, rot_z
from perception.stacking import Stack
from tests.perception.synthetic import (
    BITS,
    GAIN_E,
    READ_E,
    Scene,
    background_e,
    marker_electrons,
    noise_counts,
    observed,
    spot,
)

OFF_M, OFF_RAD = 0.150, np.radians(10.0)
GROUND_SIGMA_M = 0.020  # what the prediction allows the ground; here the truth errs by as much
CHUNK = 64


@dataclass(frozen=True)
class Nuisance:
    """What real frames do over a sequence: jitter a frame, drift in all [px], change of light in all."""

    jitter_px: float = 0.0
    drift_px: float = 0.0
    light: float = 0.0
    texture: float = 0.08

    @property
    def moves(self) -> bool:
        return (self.jitter_px, self.drift_px, self.light) != (0.0, 0.0, 0.0)


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
        Source.PREDICTION,
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
    single = filter_snr_per_pair(chain.rig, view_of(chain, setting.said)) * np.sqrt(pairs) >= SNR_WANTED
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
) -> Trial:
    """Draw, expose, localise; `dark` leaves the LEDs off, so that whatever is found is false.

    The prediction is `off` by up to so much [m], [rad].
    """
    setting = draw(range_m, rng, rig or RigCalibration(), off)
    leds, joint = sequence_for(setting, pairs)
    way = _jointly if joint else _singly
    windows = windows_of(setting)
    cameras = [
        _Camera.of(setting.true, c, w, rng, nuisance or Nuisance(), dark) for c, w in enumerate(windows)
    ]
    found, weights, seconds = way(setting, cameras, windows, leds, rng)
    limit = bound(setting, weights, GROUND_SIGMA_M if joint else np.inf)
    fix = getattr(found, "fix", None)
    why = found.why if fix is None else setting.expectation.misfit(fix.state.site_body, fix.covariance)
    if why:
        return Trial(None, None, limit, seconds, why)
    return Trial(_error(setting.said.site_body, fix), fix.covariance, limit, seconds, "")


def windows_of(setting: Setting) -> tuple[Window, Window]:
    chain, expected = setting.true.chain, setting.expectation
    margin = marker_spread(chain.rig, view_of(chain, expected.state).range_m).radius_px + 8.0
    windows = predicted_windows(chain, expected.state, expected.covariance, margin)
    assert windows is not None
    return windows


def _jointly(setting, cameras, windows, leds, rng):
    """The joint answer, the noise of each LED's difference in frames' noises, processing time."""
    chain, watch, unused = setting.true.chain, Stopwatch(), 0.0
    stacks = [Stack(4, chain.rig.sensor.noise_counts) for _ in cameras]
    for first in range(0, len(leds), CHUNK):
        part = slice(first, first + CHUNK)
        for camera, stack in zip(cameras, stacks, strict=True):
            before = watch.elapsed_s()
            frames = camera.expose(leds, part, rng)
            unused += watch.elapsed_s() - before
            stack.add(frames, leds[part])
    spread = marker_spread(chain.rig, view_of(chain, setting.expectation.state).range_m)
    corners = [(w.u, w.v) for w in windows]
    differences = [stack.difference() for stack in stacks]
    found = joint_fix(chain, differences, corners, spread, setting.expectation, setting.tilt_rad)
    seconds = watch.elapsed_s() - unused
    scatter = np.cov(lit(leds, 4).T, bias=True) * len(leds)
    return found, np.sqrt(np.diag(np.linalg.inv(scatter))), seconds


def _singly(setting, cameras, windows, leds, rng):
    """The same for markers found one by one."""
    chain, said = setting.true.chain, setting.said
    counts = tuple(camera.expose(leds, slice(None), rng) for camera in cameras)
    images = Images(0.0, Shot(leds), windows, counts, HeadReading(0.0, *said.head_rad, moving=False))
    watch = Stopwatch()
    look = look_at(chain.rig, images, view_of(chain, setting.expectation.state).range_m)
    prior = setting.expectation.prior
    found = choose(chain, look.candidates, said.head_rad, said.joints_rad, setting.tilt_rad, prior)
    return found, np.linalg.norm(pair_weights(leds, 4), axis=1), watch.elapsed_s()


def _error(true: Transform, fix: Fix) -> np.ndarray:
    body = fix.state.site_body
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
            covariance[c, m] = centre_bound(spread, _flux_e(scene, c, m) / GAIN_E, sigma, off)
    return pose_bound(scene.chain, scene.state, covariance, height_sigma_m=height_sigma_m)


def _flux_e(scene: Scene, c: int, m: int) -> float:
    return marker_electrons(scene.ranges_m[c, m]) * (1 + scene.cosines[c, m]) / 2


@dataclass
class _Camera:
    """A window's expected images: the ground with its slopes, and the patch of light of each LED [e-]."""

    ground_e: np.ndarray
    slopes_e: tuple[np.ndarray, np.ndarray] | None
    spots_e: list[tuple[tuple[slice, slice], np.ndarray]]
    nuisance: Nuisance

    @classmethod
    def of(cls, scene: Scene, c: int, w: Window, rng, nuisance: Nuisance, dark: bool) -> _Camera:
        ground = _ground_e(nuisance.texture, w, rng)
        slopes = tuple(np.gradient(ground)[::-1]) if nuisance.moves else None
        spots = [_spot_e(scene, c, m, w, 0.0 if dark else _flux_e(scene, c, m)) for m in range(4)]
        return cls(ground, slopes, spots, nuisance)

    def expose(self, leds: tuple[int, ...], part: slice, rng) -> np.ndarray:
        """Frames of a part of the sequence [counts]."""
        masks = leds[part]
        first = part.start or 0
        frames = rng.standard_normal((len(masks), *self.ground_e.shape), dtype=np.float32)
        for k, mask in enumerate(masks):
            expected = self._moved((first + k) / len(leds), rng)
            for m, (place, light) in enumerate(self.spots_e):
                if mask >> m & 1:
                    expected[place] += light
            frames[k] *= np.sqrt(expected + READ_E**2)
            frames[k] += expected
        frames /= np.float32(GAIN_E)
        np.rint(frames, out=frames)
        return np.clip(frames, 0, 2**BITS - 1, out=frames).astype(np.uint16)

    def _moved(self, progress: float, rng) -> np.ndarray:
        n = self.nuisance
        if self.slopes_e is None:
            return self.ground_e.copy()
        du, dv = n.drift_px * progress + n.jitter_px * rng.standard_normal(2)
        moved = self.ground_e - du * self.slopes_e[0] - dv * self.slopes_e[1]
        return moved * (1 + n.light * np.sin(2 * np.pi * progress))


@cache
def _sheet_e(texture: float) -> np.ndarray:
    """Ground for all trials, made once; each takes a place of its own."""
    return background_e(np.random.default_rng(0), (2048, 2048), texture).astype(np.float32)


def _ground_e(texture: float, w: Window, rng) -> np.ndarray:
    v, u = (int(rng.integers(2048 - size + 1)) for size in (w.height, w.width))
    return _sheet_e(texture)[v : v + w.height, u : u + w.width]


def _spot_e(scene: Scene, c: int, m: int, w: Window, flux_e: float):
    """Where one LED's light falls in the window, and how much."""
    u, v = scene.uv_px[c, m] - (w.u, w.v)
    reach = 4 * marker_spread(scene.chain.rig, float(scene.ranges_m[c, m])).radius_px
    left, top = (max(round(float(at)) - reach, 0) for at in (u, v))
    place = slice(top, max(top + 2 * reach, 0)), slice(left, max(left + 2 * reach, 0))
    height, width = (len(range(n)[s]) for n, s in zip((w.height, w.width), place, strict=True))
    light = spot((height, width), u - left, v - top, scene.ranges_m[c, m])
    return place, (flux_e * light).astype(np.float32)
