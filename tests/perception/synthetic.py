"""Synthetic truth for the vision tests: marker images by brute-force integration, not by the detector's code.

A scene is a textured background with the noise of a real sensor; markers are squares sampled on a fine grid
and spread by a pixel-integrated Gaussian (erf). The marker's power follows from the paper: brightest pixel of
a one-pair difference image equal to its noise at 7.5 m.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.special import erf

from executive.core.rig import RigCalibration
from perception.geometry.body import Transform
from perception.geometry.chain import Chain, ChainState
from perception.geometry.follow_up import pointing_at
from perception.geometry.rotation import exp_map
from tests.perception.sensor.noise import with_noise

FULL_WELL_E, BACKGROUND, READ_E, BITS = 160_000.0, 0.40, 40.0, 10
GAIN_E = FULL_WELL_E / (2**BITS - 1)
MOST_PIXELS = 500_000  # that are exposed at once, 4 MB of electrons: small frames many, large ones one by one


def noise_counts() -> float:
    variance_e = FULL_WELL_E * BACKGROUND + READ_E**2 + GAIN_E**2 / 12
    return float(np.sqrt(variance_e) / GAIN_E)


def blur_sigma_px(range_m: float) -> float:
    return float(np.hypot(0.5, 5.47 * abs(1 / range_m - 1 / 20.0) / 4))


def spot(
    shape: tuple[int, int], u: float, v: float, range_m: float, grid: int = 9, widen: float = 1.0
) -> np.ndarray:
    """Shares of light of one marker in an image of this shape; sums to 1 inside a large one."""
    side = 2500.0 * 0.003 / range_m
    steps = (np.arange(grid) + 0.5) / grid - 0.5

    def line(n: int, centre: float) -> np.ndarray:
        edges = (np.arange(n + 1) - 0.5)[:, None] - (centre + side * steps)[None]
        cumulative = 0.5 * (1 + erf(edges / (np.sqrt(2) * widen * blur_sigma_px(range_m))))
        return np.diff(cumulative, axis=0).mean(axis=1)

    return np.outer(line(shape[0], v), line(shape[1], u))


def marker_electrons(range_m: float) -> float:
    """Light of one marker seen face on [e-]."""
    peak_75 = spot((33, 33), 16.0, 16.0, 7.5).max()
    return np.sqrt(2) * noise_counts() * GAIN_E / peak_75 * (7.5 / range_m) ** 2


def background_e(rng: np.random.Generator, shape: tuple[int, int], texture: float = 0.08) -> np.ndarray:
    """A grainy ground [e-]."""
    grain = (
        gaussian_filter(rng.standard_normal(shape), 1.2) + gaussian_filter(rng.standard_normal(shape), 6) * 6
    )
    return FULL_WELL_E * BACKGROUND * (1 + texture * grain / grain.std())


def expose(rng: np.random.Generator, expected_e: np.ndarray) -> np.ndarray:
    """A frame (h, w) of what is expected [e-], with a real sensor's noise [counts]."""
    return _expose_all(rng, np.ascontiguousarray(expected_e[None]))[0]


def _expose_all(rng: np.random.Generator, expected_e: np.ndarray) -> np.ndarray:
    """The same of frames (n, h, w)."""
    return with_noise(rng, expected_e, READ_E, GAIN_E, 2.0**BITS - 1)


def sequence(
    rng: np.random.Generator,
    ground_e: np.ndarray,
    leds: tuple[int, ...],
    spots_e: dict[int, np.ndarray],
    light: np.ndarray | None = None,
) -> np.ndarray:
    """Frames (n, h, w): the ground, lit by `light` per frame, plus the spots of the LEDs that are on."""
    light = np.ones(len(leds)) if light is None else light
    at_once = max(1, MOST_PIXELS // ground_e.size)
    frames = []
    for first in range(0, len(leds), at_once):
        some = slice(first, first + at_once)
        expected_e = ground_e * light[some, None, None]
        for frame_e, mask in zip(expected_e, leds[some], strict=True):
            for marker, spot_e in spots_e.items():
                if mask >> marker & 1:
                    frame_e += spot_e
        frames.append(_expose_all(rng, expected_e))
    return np.concatenate(frames)


@dataclass(frozen=True)
class Scene:
    """A rover at a place: the chain, the true state as encoders say it, and where its markers appear."""

    chain: Chain
    state: ChainState
    uv_px: np.ndarray
    ranges_m: np.ndarray
    cosines: np.ndarray

    @property
    def range_m(self) -> float:
        return float(self.ranges_m.max())


def scene(
    range_m: float,
    turn: tuple[float, float, float] = (0.02, -0.03, 0.6),
    joints: tuple[float, float] = (0.0, 0.0),
    bearing: float = 0.1,
    rig: RigCalibration | None = None,
) -> Scene:
    """A rover about `range_m` from the head, looked at in the stereoscopic middle."""
    chain = Chain.of(rig or RigCalibration())
    ground = np.sqrt(max(range_m**2 - 1.35**2, 0.2))
    body = Transform(
        exp_map(np.array(turn)), np.array([ground * np.cos(bearing), ground * np.sin(bearing), 0.02])
    )
    head = pointing_at(chain, body.position_m + np.array([0, 0, 0.12]))
    state = ChainState(body, head, joints)
    return observed(chain, state)


def observed(chain: Chain, state: ChainState) -> Scene:
    uv, _ = chain.project(state)
    cameras = chain.site_ih(state.head_rad).apply(chain.model.position_ih_m)
    to_camera = cameras[:, None] - chain.markers_site(state)[None]
    ranges = np.linalg.norm(to_camera, axis=-1)
    cosines = to_camera @ chain.site_plc(state).rotation[:, 2] / ranges
    return Scene(chain, state, uv, ranges, cosines)
