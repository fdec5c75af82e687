"""A fix without any light of the rover's own: its outline, its shades and its shadow against the empty ground.

The height of the surveyed ground is not put into the pose, it is held against it: stereo sees the range by
itself, and a survey that is wrong by some millimetres would pull a distant rover by decimetres.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from executive.types import Array, Window
from perception.body import Transform
from perception.chain import Chain
from perception.checks import as_finite
from perception.passive.alignment import SIZE, Aligned, Start, align
from perception.passive.background import lay_under
from perception.passive.drawing import Artist, Stands
from perception.passive.matching import Detail, Scene, first_detail, refined_detail, weigh
from perception.passive.searching import search
from perception.passive.solids import rover_solids
from perception.pose import chi2_limit
from perception.prediction import Expectation
from perception.roi import predicted_windows
from perception.rotation import skew

_LOOSE_M, _LOOSE_RAD = 1.0, math.radians(30.0)
_MARGIN_M = 0.45  # around the markers: the rest of the rover, its shadow, and ground to know again
_FINE_MARGIN_PX = 5
_FIRST_STEPS, _FINALISTS, _MORE_STEPS = 1, 2, 3
_ROUNDS, _MOST_STEPS = 2, 15  # each round weighs the pixels anew
_GATE = 0.999
_LEAST_EXPLAINED = 0.5  # of what changed against the background
_MOST_DETAIL = 0.3  # that the drawing may leave out, over the ground's brightness
_FLOOR_PX = 0.05  # what background, drawing and lens calibration leave


@dataclass(frozen=True)
class Ground:
    """Height of the surveyed ground under the rover [m, site] and how well it is known."""

    height_m: float
    sigma_m: float


@dataclass(frozen=True)
class Sun:
    """Where the sun stands, to a degree or so: azimuth from site x, left positive, and elevation [rad]."""

    azimuth_rad: float
    elevation_rad: float


@dataclass(frozen=True, eq=False)
class PassiveFix:
    """An accepted pose: body in site, covariance (6, 6) in the order of PoseEstimate, and what it rests on."""

    site_body: Transform
    covariance: Array
    explained: float
    note: str


@dataclass(frozen=True)
class PassiveRefusal:
    """Why there is no fix."""

    why: str


def empty_window(chain: Chain, expectation: Expectation) -> tuple[Window, Window]:
    """Windows that hold the expected rover, its shadow and ground around it; ValueError if out of sight."""
    range_m = float(np.linalg.norm(expectation.state.site_body.position_m))
    margin = _MARGIN_M * chain.rig.cameras[0].focal_px / max(range_m, 1.0)
    small = np.diag(np.diag(expectation.covariance) * [1, 1, 1, 1, 1, 1])
    windows = predicted_windows(chain, expectation.state, small, margin, 0.25)
    if windows is None:
        raise ValueError("got a rover expected out of the cameras' sight, expected one in both frames")
    return windows


def passive_fix(
    chain: Chain,
    images: Sequence[NDArray[np.uint16]],
    backgrounds: Sequence[NDArray[np.uint16]],
    windows: tuple[Window, Window],
    expectation: Expectation,
    ground: Ground,
    sun: Sun,
) -> PassiveFix | PassiveRefusal:
    """The pose that images (frames, h, w) of both cameras show against the empty views (frames, h, w).

    All in counts and of the same `windows`, LEDs off, the head as the expectation's encoders say. ValueError
    on other shapes or values.
    """
    state = expectation.state
    solids = rover_solids(chain.rig, state.joints_rad)
    start = _start(chain, expectation, ground, sun)
    focal_px = chain.rig.cameras[0].focal_px
    scenes = []
    for camera, window in enumerate(windows):
        image, noise = _mean(f"images[{camera}]", images[camera], window, chain.rig.sensor.noise_counts)
        empty, _ = _mean(f"backgrounds[{camera}]", backgrounds[camera], window, noise)
        under = lay_under(image, empty, noise)
        if under.problem:
            return PassiveRefusal(f"{('left', 'right')[camera]} camera: {under.problem}")
        artist = Artist(chain, solids, state.head_rad, camera, window)
        scenes.append(Scene(image, noise, under, artist, focal_px / start.range_m))
    best, close = _approached(scenes, start, focal_px)
    for _ in range(_ROUNDS):
        details = [refined_detail(s, m) for s, m in zip(close, best.matches, strict=True)]
        sigmas = _sigmas(close, start, best.parameters, details)
        best = align(close, start, best.parameters, sigmas, focal_px, _MOST_STEPS)
    return _judged(chain, best, close, details, ground)


def _approached(scenes: Sequence[Scene], start: Start, focal_px: float) -> tuple[Aligned, list[Scene]]:
    """The best of the starts, and the scenes cut to where it led: each round goes on with fewer of them."""
    near = []
    for guess in search(scenes, start, focal_px):
        close = [_cropped(s, start.stands(guess.parameters[None])) for s in scenes]
        sigmas = _sigmas(close, start, guess.parameters, [first_detail(s) for s in close])
        near.append((align(close, start, guess.parameters, sigmas, focal_px, _FIRST_STEPS), close, sigmas))
    near = sorted(near, key=lambda n: n[0].cost)[:_FINALISTS]
    further = [
        (align(close, start, found.parameters, sigmas, focal_px, _MORE_STEPS), close)
        for found, close, sigmas in near
    ]
    return min(further, key=lambda f: f[0].cost)


def _sigmas(
    scenes: Sequence[Scene], start: Start, parameters: Array, details: Sequence[Detail]
) -> list[Array]:
    stands = start.stands(parameters[None])
    return [weigh(s, stands, d) for s, d in zip(scenes, details, strict=True)]


def _mean(name: str, frames: NDArray[np.uint16], window: Window, noise: float) -> tuple[Array, float]:
    stack = as_finite(name, np.asarray(frames), (None, window.height, window.width))
    return stack.mean(axis=0), noise / math.sqrt(len(stack))


def _start(chain: Chain, expectation: Expectation, ground: Ground, sun: Sun) -> Start:
    body = expectation.state.site_body
    level = chain.rig.rover.inclinometer_sigma_rad
    eye = chain.site_ih(expectation.state.head_rad).position_m
    position = np.array([*body.position_m[:2], ground.height_m])
    sigma = np.array([_LOOSE_M, _LOOSE_M, _LOOSE_M, level, level, _LOOSE_RAD])
    return Start(
        replace(body, position_m=position),
        np.array([sun.azimuth_rad, sun.elevation_rad]),
        eye,
        np.zeros(SIZE),
        sigma,
    )


def _cropped(scene: Scene, stands: Stands) -> Scene:
    """The scene cut to the rover and its shadow at this pose."""
    artist = scene.artist.framing(stands, _FINE_MARGIN_PX)
    top, left = artist.window.v - scene.artist.window.v, artist.window.u - scene.artist.window.u
    part = np.s_[top : top + artist.window.height, left : left + artist.window.width]
    whole = scene.background
    under = replace(whole, counts=whole.counts[part], sigma=whole.sigma[part])
    return replace(scene, image=scene.image[part], background=under, artist=artist)


def _judged(
    chain: Chain, best: Aligned, scenes: Sequence[Scene], details: Sequence[Detail], ground: Ground
) -> PassiveFix | PassiveRefusal:
    if not best.converged:
        return PassiveRefusal("no best pose was reached")
    for scene, detail in zip(scenes, details, strict=True):
        if detail.rover > _MOST_DETAIL * scene.brightness:
            return PassiveRefusal(
                f"the rover's drawing leaves {detail.rover / scene.brightness:.0%} of the brightness open"
            )
    explained = _explained(best, scenes)
    if explained < _LEAST_EXPLAINED:
        return PassiveRefusal(f"the rover explains {explained:.0%} of what changed")
    covariance = _site_covariance(chain, best)
    body = best.site_body
    off = ground.height_m - body.position_m[2]
    sigma = math.hypot(ground.sigma_m, math.sqrt(covariance[2, 2]))
    if (off / sigma) ** 2 > chi2_limit(1, _GATE):
        return PassiveRefusal(
            f"the ground was surveyed {off * 1e3:.0f} mm off where the rover stands, "
            f"{abs(off) / sigma:.1f} sigmas"
        )
    note = f"outline explains {explained:.0%} of what changed; ground {off * 1e3:+.1f} mm off the survey"
    return PassiveFix(body, covariance, explained, note)


def _explained(best: Aligned, scenes: Sequence[Scene]) -> float:
    """Share of the change against the background that rover and shadow account for."""
    changed = sum(float(((s.image - s.background.counts) ** 2).sum()) for s in scenes)
    left = sum(float((m.residual[0] ** 2).sum()) for m in best.matches)
    return 1 - left / max(changed, 1e-9)


def _site_covariance(chain: Chain, best: Aligned) -> Array:
    """Covariance (6, 6) of the body in site: of the images, of the head's angles, and a floor."""
    turn = np.eye(6)
    turn[:3, :3] = best.start.axes
    covariance = turn @ best.covariance[:6, :6] @ turn.T
    body = best.site_body
    arm = body.position_m - best.start.eye_m
    lateral = best.start.axes[:, 1]
    by_head = np.zeros((6, 2))
    by_head[:3, 0], by_head[3:, 0] = skew(np.array([0.0, 0.0, 1.0])) @ arm, [0.0, 0.0, 1.0]
    by_head[:3, 1] = skew(lateral) @ arm  # roll and pitch come from the inclinometers, whatever the head says
    head = chain.encoder_sigma_rad()[:2]
    total: Array = covariance + by_head @ np.diag(head**2) @ by_head.T + _floor(chain, best)
    return (total + total.T) / 2


def _floor(chain: Chain, best: Aligned) -> Array:
    """What a few hundredths of a pixel, alike over a whole image, do to the pose."""
    cameras = chain.rig.cameras
    base_m = float(np.linalg.norm(np.subtract(cameras[0].position_ih_m, cameras[1].position_ih_m)))
    range_m, focal_px = best.start.range_m, cameras[0].focal_px
    sight = best.site_body.position_m - best.start.eye_m
    sight = sight / range_m
    along = math.sqrt(2.0) * _FLOOR_PX * range_m**2 / (focal_px * base_m)
    across = _FLOOR_PX * range_m / focal_px
    floor = np.zeros((6, 6))
    floor[:3, :3] = across**2 * np.eye(3) + along**2 * np.outer(sight, sight)
    floor[3, 3] = floor[4, 4] = chain.rig.rover.inclinometer_sigma_rad**2
    floor[5, 5] = (across / 0.15) ** 2
    return floor
