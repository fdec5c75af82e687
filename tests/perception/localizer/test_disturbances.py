"""One thing wrong at a time: the rover is found where it is, or refused in words that say what is wrong."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from executive.core.rig import RigCalibration
from perception.frames.codes import coded_sequence
from perception.frames.shots import (
    blackness,
    fresh,
    staleness,
    stuck_pixels,
)
from perception.frames.similarity import compare
from perception.frames.stacking import Stack
from perception.frames.vibration import Movable, coarse_shifts, unknown_px
from perception.markers.identity import exchanges
from tests.perception.disturbances import MATRIX
from tests.perception.far_trials import run_trial
from tests.perception.synthetic import noise_counts
from tests.perception.trial_camera import Disturbance

NEAR, FAR = (3.0, 3), (12.0, 80)
OFF = (0.05, np.radians(3.0))


def trial(name, where, seed):
    range_m, pairs = where
    rng = np.random.default_rng([21, list(MATRIX).index(name), pairs, seed])
    return run_trial(range_m, pairs, rng, off=OFF, disturbance=MATRIX[name].make())


@pytest.mark.parametrize("where", [NEAR, FAR])
@pytest.mark.parametrize("name", MATRIX)
def test_what_disturbs_gives_no_false_pose_and_the_right_reason(name, where):
    for seed in range(2 if where == NEAR else 1):
        found = trial(name, where, seed)
        assert not found.false
        assert found.detected or MATRIX[name].says(found.why), found.why


@pytest.mark.parametrize("where", [NEAR, FAR])
@pytest.mark.parametrize("name", ["camera_dead", "head_vibration", "hot_pixels", "light_drift"])
def test_what_can_be_seen_through_is_seen_through(name, where):
    found = trial(name, where, 5)
    assert found.detected, found.why
    assert found.nees < 25


class BothDead(Disturbance):
    """No camera shows anything."""

    def delivered(self, camera, first, counts):
        return np.zeros_like(counts)


@pytest.mark.parametrize(("range_m", "pairs"), [NEAR, FAR])
def test_without_any_camera_both_are_named(range_m, pairs):
    found = run_trial(range_m, pairs, np.random.default_rng(1), off=OFF, disturbance=BothDead())
    assert not found.detected
    assert "left camera: " in found.why
    assert "right camera: " in found.why


def frames(rng, count=24, shape=(40, 60)):
    return rng.normal(400, 1.7, (count, *shape)).round().astype(np.uint16)


def test_frames_read_out_twice_and_empty_ones_are_told_from_exposures():
    counts = frames(np.random.default_rng(2))
    counts[7], counts[12] = counts[6], 0
    kept = fresh(counts)
    assert np.flatnonzero(~kept).tolist() == [7, 12]
    assert staleness(kept) == ""
    counts[1:] = counts[0]
    assert "23 of 24 frames repeat" in staleness(fresh(counts))


def test_a_camera_is_black_only_beside_one_that_is_not():
    left, right = blackness((0.0, 400.0))
    assert left.startswith("black")
    assert right == ""
    assert blackness((0.0, 1.0)) == ("", "")


def test_pixels_that_never_leave_full_or_empty_are_stuck():
    counts = frames(np.random.default_rng(3))
    counts[:, 3, 4], counts[:, 5, 6], counts[0, 7, 8] = 1023, 0, 1023
    stuck = stuck_pixels(counts, RigCalibration().sensor)
    assert np.argwhere(stuck).tolist() == [[3, 4], [5, 6]]


def test_a_flickering_pixel_has_less_say_and_a_constant_one_none():
    rng, leds = np.random.default_rng(4), coded_sequence(4, 32)
    counts = frames(rng, len(leds))
    counts[:, 10, 10] += np.uint16(60) * rng.integers(0, 2, len(leds)).astype(np.uint16)
    counts[:, 20, 20] = 1023
    stack = Stack(4, noise_counts())
    stack.add(counts, leds)
    sigma = stack.difference().sigma[0]
    assert sigma[10, 10] > 8 * np.median(sigma)
    assert sigma[20, 20] > 1e5


def test_frames_of_a_vibrating_head_are_aligned():
    rng = np.random.default_rng(5)
    ground = 400 + 60 * gaussian_filter(rng.standard_normal((80, 120)), 1.5) / 0.19
    off = rng.uniform(-2.5, 2.5, (16, 2))
    off -= off.mean(axis=0)
    still = np.repeat(ground[None], 16, axis=0).astype(np.float32)
    shaken = Movable(still).moved_back(-off) + rng.normal(0, 1.7, still.shape).astype(np.float32)
    frames = shaken.astype(np.float32)
    np.testing.assert_allclose(coarse_shifts(frames, Movable(frames)), off, atol=0.6)
    found = compare(shaken.round().astype(np.uint16), 1.7)
    assert found.problem == ""
    np.testing.assert_allclose(found.shift_px, off, atol=0.1)
    assert found.rest_counts.max() < 1.7 * 1.7


@pytest.mark.parametrize("frames", [5, 9, 64])
def test_the_mean_pointing_is_as_uncertain_as_is_said(frames: int):
    off = np.random.default_rng(7).standard_normal((4000, frames, 2))
    mean = off.mean(axis=1)
    said = np.array([unknown_px(one - middle) for one, middle in zip(off, mean, strict=True)])
    assert ((mean / said[:, None]) ** 2).mean() == pytest.approx(1.0, rel=0.08)


def test_moving_a_frame_leaves_its_noise_as_it_was():
    noise = np.random.default_rng(6).standard_normal((4, 200, 200)).astype(np.float32)
    moved = Movable(noise).moved_back(np.full((4, 2), 0.5))
    assert moved.std() == pytest.approx(1.0, rel=0.02)


def test_leds_can_be_exchanged_in_one_couple_or_two():
    orders = [tuple(order) for order, _ in exchanges(4)]
    assert len(orders) == len(set(orders)) == 9
    assert (1, 0, 3, 2) in orders
    assert (0, 1, 2, 3) not in orders
