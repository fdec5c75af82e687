"""The two tiers side by side: centres the real detector finds in images, and centres drawn from the model."""

from __future__ import annotations

import numpy as np
import pytest

from executive.core.clock import Clock
from executive.core.types import HeadReading, Shot, Window
from sim_pybullet.cameras import make_cameras
from sim_pybullet.projection import head_views
from sim_pybullet.radiometry import Exposure
from tests.sim_pybullet.sensor_scenes import (
    RIG,
    SUN,
    flat_ground,
    picture,
    scene_at,
)

differencing = pytest.importorskip("perception.frames.difference", reason="compares with the real detector")
detecting = pytest.importorskip("perception.markers.centres", reason="compares with the real detector")
spreads = pytest.importorskip("perception.frames.psf", reason="compares with the real detector")

_RANGE_M, _PAIRS, _SHOTS = 3.0, 8, 40
_SCENE = scene_at(flat_ground(), _RANGE_M, 0.0, heading_rad=0.4)


def _true_px() -> np.ndarray:
    pic = picture()
    return np.array([[(s.u_px, s.v_px) for s in pic.spots(_SCENE, c)] for c in (0, 1)])


def _answers(tier: str, shot: Shot) -> list:
    clock = Clock()
    head = HeadReading(0.0, _SCENE.head_pan_rad, _SCENE.head_tilt_rad, False)
    rng = np.random.default_rng(21)
    cameras = make_cameras(tier, RIG, clock, lambda: _SCENE, lambda: head, flat_ground(), SUN, rng)
    answers = []
    for _ in range(_SHOTS):
        action = cameras.take(shot)
        while (outcome := action.poll()) is None:
            clock.advance()
            cameras.tick()
        answers.append(outcome.value)
    return answers


def _detected(images, camera: int) -> np.ndarray:
    """Centres (4, 2) found by the perception package in one camera's stack, NaN where none."""
    frames, window = images.counts[camera].astype(np.float32), images.windows[camera]
    found = differencing.difference(frames, images.shot.leds, 4, Exposure(10).noise_counts)
    eye = head_views(RIG, _SCENE.head_pan_rad, _SCENE.head_tilt_rad)[camera].position_site_m
    spread = spreads.marker_spread(RIG, float(np.linalg.norm(eye - _SCENE.T_site_plc[:3, 3])))
    centres = np.full((4, 2), np.nan)
    for marker in range(4):
        best = detecting.find_markers(
            found.images[marker], found.sigma[marker], spread, (window.u, window.v)
        )[:1]
        if best:
            centres[marker] = best[0].uv_px
    return centres


def test_both_tiers_find_markers_equally_often_and_equally_well():
    true = _true_px()
    low = np.floor(true.min(axis=1)).astype(int) - 20
    high = np.ceil(true.max(axis=1)).astype(int) + 21
    windows = tuple(Window(*map(int, (*a, *(b - a)))) for a, b in zip(low, high, strict=True))
    shot = Shot(differencing.led_sequence(4, _PAIRS), (windows[0], windows[1]))
    full = np.array([[_detected(images, c) for c in (0, 1)] for images in _answers("full", shot)]) - true
    cheap = np.array([centres.uv_px for centres in _answers("geometric", shot)]) - true
    seen = [np.isfinite(errors).mean() for errors in (full, cheap)]
    assert seen[0] == pytest.approx(seen[1], abs=0.05)
    assert np.abs(np.nanmean(full, axis=0)).max() < 0.12
    assert np.nanstd(full) == pytest.approx(np.nanstd(cheap), rel=0.15)
