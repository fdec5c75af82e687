"""Counts: noise statistics, saturation, bloom, quantisation, and the seed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from executive.core.rig import RigCalibration
from sim_pybullet.radiometry import FULL_WELL_E, READ_NOISE_E, Exposure
from sim_pybullet.sensor import Sensor, bloomed

_EXPOSURE = Exposure(10)


def _counts(level_e: float, frames: int = 400, seed: int = 3, exposure: Exposure = _EXPOSURE):
    image = np.full((24, 24), level_e, dtype=np.float32)
    return Sensor(exposure, np.random.default_rng(seed)).expose(image, frames)


@pytest.mark.parametrize("level_e", [8_000.0, 64_000.0, 120_000.0])
def test_mean_and_variance_are_those_of_shot_read_and_quantisation_noise(level_e):
    counts = _counts(level_e).astype(float)
    variance = (level_e + READ_NOISE_E**2) / _EXPOSURE.gain_e**2 + 1 / 12
    assert counts.mean() == pytest.approx(level_e / _EXPOSURE.gain_e, abs=0.02)
    assert counts.var() == pytest.approx(variance, rel=0.02)
    assert counts.var(axis=0, ddof=1).mean() == pytest.approx(variance, rel=0.02)


def test_darkness_reads_as_zero():
    assert _counts(0.0).max() <= 2
    assert _counts(0.0).mean() < 0.2


def test_noise_of_sunlit_ground_is_what_the_rig_says():
    assert _counts(_EXPOSURE.ground_e).std() == pytest.approx(RigCalibration().sensor.noise_counts, rel=0.03)


def test_neighbouring_pixels_and_frames_are_independent():
    noise = _counts(64_000.0).astype(float)
    noise -= noise.mean()
    for a, b in ((noise[1:], noise[:-1]), (noise[:, 1:], noise[:, :-1]), (noise[..., 1:], noise[..., :-1])):
        assert abs((a * b).mean() / noise.var()) < 5 / math.sqrt(a.size)


def test_more_bits_leave_only_shot_and_read_noise():
    fine = Exposure(16)
    expected = math.sqrt(64_000 + READ_NOISE_E**2)
    assert _counts(64_000.0, exposure=fine).std() * fine.gain_e == pytest.approx(expected, rel=0.01)


def test_counts_saturate_at_the_full_well():
    counts = _counts(3 * FULL_WELL_E)
    assert counts.min() >= _EXPOSURE.max_count - 1
    assert (counts == _EXPOSURE.max_count).mean() > 0.9


def test_overflowing_charge_spills_up_and_down_its_column_only():
    image = np.full((41, 9), 10_000.0, dtype=np.float32)
    image[20, 4] = 1_000_000.0
    held = bloomed(image, FULL_WELL_E)
    others = np.delete(held, 4, axis=1)
    assert (others == 10_000.0).all()
    assert held.max() <= FULL_WELL_E
    assert held[:, 4].sum() == pytest.approx(image[:, 4].sum(), rel=1e-5)
    np.testing.assert_allclose(held[:, 4], held[::-1, 4], rtol=1e-5)
    assert held[18, 4] == pytest.approx(FULL_WELL_E)


def test_charge_that_reaches_the_end_of_a_column_is_lost():
    image = np.full((5, 3), 100_000.0, dtype=np.float32)
    image[2, 1] = 5_000_000.0
    assert (bloomed(image, FULL_WELL_E)[:, 1] == np.float32(FULL_WELL_E)).all()


def test_an_image_below_the_full_well_does_not_bloom():
    image = np.full((5, 3), FULL_WELL_E, dtype=np.float32)
    assert bloomed(image, FULL_WELL_E) is image


def test_same_seed_gives_the_same_counts_and_another_does_not():
    assert (_counts(64_000.0, seed=3) == _counts(64_000.0, seed=3)).all()
    assert (_counts(64_000.0, seed=3) != _counts(64_000.0, seed=4)).mean() > 0.5
