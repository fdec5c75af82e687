"""Repeated localisation of one true pose from synthetic images, with the bound for the same images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from perception.frames.difference import difference, led_sequence, pair_weights
from perception.frames.psf import marker_spread
from perception.frames.similarity import compare
from perception.geometry.chain import ChainState
from perception.geometry.pose import roll_pitch
from perception.geometry.rotation import log_map
from perception.markers.centres import find_markers
from perception.markers.fisher import centre_bound, pose_bound
from perception.markers.marker_fix import MarkerFix
from perception.markers.plausibility import choose
from tests.perception.synthetic import (
    GAIN_E,
    Scene,
    background_e,
    marker_electrons,
    noise_counts,
    observed,
    sequence,
    spot,
)

CROP_PX = 45


@dataclass(frozen=True)
class Campaign:
    """Errors (trials, 6) of position [m] and rotation [rad] in site, NEES, the bound (6, 6), tries."""

    errors: np.ndarray
    nees: np.ndarray
    bound: np.ndarray
    tried: int

    @property
    def position_ratio(self) -> float:
        rmse = np.sqrt((self.errors[:, :3] ** 2).sum(axis=1).mean())
        return float(rmse / np.sqrt(np.trace(self.bound[:3, :3])))

    @property
    def yaw_ratio(self) -> float:
        return float(np.sqrt((self.errors[:, 5] ** 2).mean() / self.bound[5, 5]))


def run(scene: Scene, pairs: int, trials: int, rng: np.random.Generator) -> Campaign:
    """Localise `trials` times; head, joints and inclinometers err as the rig's calibration says."""
    leds = led_sequence(1, pairs)
    errors, nees = [], []
    for _ in range(trials):
        result = trial(scene, leds, rng)
        if result is not None:
            errors.append(result[0])
            nees.append(result[0] @ np.linalg.solve(result[1], result[0]))
    return Campaign(np.array(errors), np.array(nees), bound(scene, leds), trials)


def trial(scene: Scene, leds, rng) -> tuple[np.ndarray, np.ndarray] | None:
    """Error and covariance of one localisation, None if nothing was accepted."""
    chain, said = scene.chain, scene.state
    half_widths = np.array([chain.rig.head.pan_accuracy_rad, chain.rig.head.tilt_accuracy_rad])
    head = tuple(np.array(said.head_rad) + half_widths * rng.uniform(-1, 1, 2))
    joints = tuple(np.array(said.joints_rad) + chain.rig.cabin.joint_sigma_rad * rng.standard_normal(2))
    true = observed(chain, ChainState(said.site_body, head, joints))
    tilt, _ = roll_pitch(said.site_body.rotation)
    tilt = tilt + chain.rig.rover.inclinometer_sigma_rad * rng.standard_normal(2)
    candidates = [[_detect(true, c, m, leds, rng) for m in range(4)] for c in (0, 1)]
    fix = choose(chain, candidates, said.head_rad, said.joints_rad, tuple(tilt))
    if not isinstance(fix, MarkerFix):
        return None
    body = fix.fit.state.site_body
    turn = log_map(said.site_body.rotation @ body.rotation.T)
    return np.concatenate([said.site_body.position_m - body.position_m, turn]), fix.fit.covariance


def _flux_e(scene: Scene, c: int, m: int) -> float:
    return marker_electrons(scene.ranges_m[c, m]) * (1 + scene.cosines[c, m]) / 2


def _detect(scene: Scene, c: int, m: int, leds, rng):
    """One marker in a window of its own, which keeps a campaign of thousands of images fast."""
    u, v = scene.uv_px[c, m]
    corner = (round(u) - CROP_PX // 2, round(v) - CROP_PX // 2)
    light = _flux_e(scene, c, m) * spot(
        (CROP_PX, CROP_PX), u - corner[0], v - corner[1], scene.ranges_m[c, m]
    )
    stack = sequence(rng, background_e(rng, (CROP_PX, CROP_PX), 0.02), leds, {0: light})
    noise = scene.chain.rig.sensor.noise_counts
    found = difference(compare(stack, noise).frames, leds, 1, noise)
    spread = marker_spread(scene.chain.rig, float(scene.ranges_m.mean()))
    return find_markers(found.images[0], found.sigma[0], spread, corner, 0.02)


def bound(scene: Scene, leds) -> np.ndarray:
    """The Cramer-Rao bound of the pose for the images that `trial` makes."""
    sigma = noise_counts() * float(np.linalg.norm(pair_weights(leds, 1)))
    covariance = np.zeros((2, 4, 2, 2))
    for c in (0, 1):
        for m in range(4):
            spread = marker_spread(scene.chain.rig, float(scene.ranges_m[c, m]))
            off = scene.uv_px[c, m] - np.round(scene.uv_px[c, m])
            covariance[c, m] = centre_bound(spread, _flux_e(scene, c, m) / GAIN_E, sigma, off)
    return pose_bound(scene.chain, scene.state, covariance)
