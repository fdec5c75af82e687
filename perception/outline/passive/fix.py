"""A fix without any light of the rover's own: outline, shades and shadow against the empty ground.

The height of the surveyed ground is not put into the pose, it is held against it: stereo sees the range by
itself, and a survey that is wrong by some millimetres would pull a distant rover by decimetres.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from executive.core.types import Array, Window
from perception.geometry.chain import Chain
from perception.geometry.checks import as_finite
from perception.geometry.prediction import Expectation
from perception.geometry.roi import predicted_windows
from perception.outline.passive.alignment import SIZE, Start
from perception.outline.passive.background import lay_under
from perception.outline.passive.binning import (
    Frames,
    binned,
    binned_rig,
    binning_for,
)
from perception.outline.passive.drawing import Artist
from perception.outline.passive.judging import (
    Ground,
    PassiveFix,
    PassiveRefusal,
    Sun,
    judged,
)
from perception.outline.passive.matching import CameraScene
from perception.outline.passive.solids import rover_solids
from perception.outline.passive.ways import (
    RIVAL,
    approached,
    chosen,
    followed,
)

_LOOSE_M, _LOOSE_RAD = 1.0, math.radians(30.0)
_MARGIN_M = 0.45  # around the markers: the rest of the rover, its shadow, and ground to know again
_WIDEN = 0.25  # of the prediction's four sigmas: the margin does the rest
_ANY_SUN_RAD = np.radians([(az, el) for az in range(-180, 180, 30) for el in (20.0, 35.0, 55.0)])


def empty_window(chain: Chain, expectation: Expectation) -> tuple[Window, Window]:
    """Windows that hold the expected rover, its shadow and ground around it; ValueError if out of sight."""
    range_m = float(np.linalg.norm(expectation.state.site_body.position_m))
    margin_px = _MARGIN_M * chain.rig.cameras[0].focal_px / max(range_m, 1.0)
    windows = predicted_windows(chain, expectation.state, expectation.covariance, margin_px, _WIDEN)
    if windows is None:
        raise ValueError("got a rover expected out of the cameras' sight, expected one in both frames")
    return windows


def passive_fix(
    chain: Chain,
    images: Sequence[Frames],
    backgrounds: Sequence[Frames],
    windows: tuple[Window, Window],
    expectation: Expectation,
    ground: Ground,
    sun: Sun | None = None,
) -> PassiveFix | PassiveRefusal:
    """The pose that images (frames, h, w) of both cameras show against the empty views (frames, h, w).

    All in counts and of the same `windows`, LEDs off, the head as the expectation's encoders say. Without
    `sun` it is found from the shadow, which takes longer. ValueError on other shapes or values.
    """
    start = _start(chain, expectation, ground)
    by = binning_for(chain.rig, start.range_m)
    coarse = Chain.of(binned_rig(chain.rig, by))
    scenes = []
    for camera in (0, 1):
        taken = [
            _checked(f"{name}[{camera}]", frames[camera], windows[camera])
            for name, frames in (("images", images), ("backgrounds", backgrounds))
        ]
        (image, window), (empty, _) = (binned(frames, windows[camera], by) for frames in taken)
        scene = _scene(coarse, expectation, camera, window, image, empty)
        if scene.background.problem:
            return PassiveRefusal(f"{('left', 'right')[camera]} camera: {scene.background.problem}")
        scenes.append(scene)
    focal_px = coarse.rig.cameras[0].focal_px
    suns_rad = _ANY_SUN_RAD if sun is None else np.array([[sun.azimuth_rad, sun.elevation_rad]])
    ways = [followed(way, focal_px, sun is None) for way in approached(scenes, start, focal_px, suns_rad)]
    best, lead = chosen(ways, focal_px)
    if lead < RIVAL:
        return PassiveRefusal(f"two poses explain the images, {lead:.1f} apart in log likelihood")
    return judged(coarse, best.aligned, best.scenes, best.details, ground)


def _checked(name: str, frames: Frames, window: Window) -> Frames:
    as_finite(name, frames, (None, window.height, window.width))
    return np.asarray(frames)


def _scene(
    chain: Chain, expectation: Expectation, camera: int, window: Window, image: Array, empty: Array
) -> CameraScene:
    """One camera's frames (n, h, w) as a mean over its background."""
    state = expectation.state
    noise = chain.rig.sensor.noise_counts / math.sqrt(len(image))
    under = lay_under(image.mean(axis=0), empty.mean(axis=0), noise)
    artist = Artist(chain, rover_solids(chain.rig, state.joints_rad), state.head_rad, camera, window)
    range_m = float(np.linalg.norm(state.site_body.position_m))
    return CameraScene(image.mean(axis=0), noise, under, artist, chain.rig.cameras[0].focal_px / range_m)


def _start(chain: Chain, expectation: Expectation, ground: Ground) -> Start:
    body = expectation.state.site_body
    level = chain.rig.rover.inclinometer_sigma_rad
    eye = chain.site_ih(expectation.state.head_rad).position_m
    position = np.array([*body.position_m[:2], ground.height_m])
    sigma = np.array([_LOOSE_M, _LOOSE_M, _LOOSE_M, level, level, _LOOSE_RAD])
    return Start(
        replace(body, position_m=position),
        _ANY_SUN_RAD[0],
        eye,
        np.zeros(SIZE),
        sigma,
    )
