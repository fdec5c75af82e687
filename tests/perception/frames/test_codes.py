"""Coded LED sequences and their stacking."""

import numpy as np
import pytest

from perception.frames.codes import (
    coded_sequence,
    is_coded,
    lit,
    walsh_codes,
)
from perception.frames.difference import led_sequence
from perception.frames.stacking import Stack
from tests.perception.synthetic import GAIN_E, background_e, expose, noise_counts, sequence, spot

SHAPE = (60, 90)


def stacked(leds, frames, at_once=48):
    stack = Stack(4, noise_counts())
    for first in range(0, len(leds), at_once):
        stack.add(frames[first : first + at_once], leds[first : first + at_once])
    return stack


def test_codes_are_balanced_orthogonal_and_of_high_sequency():
    codes = walsh_codes(4)
    np.testing.assert_array_equal(codes @ codes.T, 8 * np.eye(4))
    np.testing.assert_array_equal(codes.sum(axis=1), 0)
    assert np.count_nonzero(np.diff(codes, axis=1), axis=1).min() >= 4


@pytest.mark.parametrize("pairs", [4, 50, 300])
def test_every_led_is_on_in_half_of_the_frames(pairs):
    leds = coded_sequence(4, pairs)
    assert len(leds) == 2 * pairs
    np.testing.assert_allclose(lit(leds, 4).sum(axis=0), pairs, atol=2)
    assert is_coded(leds)
    assert not is_coded(led_sequence(4, 3))


def test_too_few_frames_to_tell_the_leds_apart_are_refused():
    with pytest.raises(ValueError, match=r"got 3 pairs for 4 markers, expected 4 or more"):
        coded_sequence(4, 3)


@pytest.mark.parametrize("leds", [coded_sequence(4, 32), led_sequence(4, 16)], ids=["coded", "one by one"])
def test_each_stacked_image_holds_its_own_marker_only(leds):
    rng = np.random.default_rng(1)
    spots = {m: 4e4 * spot(SHAPE, 20.0 + 15 * m, 30.0, 10.0) for m in range(4)}
    found = stacked(leds, sequence(rng, background_e(rng, SHAPE), leds, spots)).difference()
    for m in range(4):
        around = found.images[:, 26:35, 16 + 15 * m : 25 + 15 * m].sum(axis=(1, 2))
        assert around[m] == pytest.approx(4e4 / GAIN_E, rel=0.1)
        assert np.abs(np.delete(around, m)).max() < 0.1 * around[m]


def test_a_coded_stack_has_the_noise_of_its_pairs_and_says_so():
    rng = np.random.default_rng(2)
    leds = coded_sequence(4, 50)
    ground = background_e(rng, SHAPE, 0.02)
    stack = stacked(leds, sequence(rng, ground, leds, {}))
    found = stack.difference()
    assert stack.pairs == 50
    assert np.median(found.sigma) == pytest.approx(noise_counts() * np.sqrt(2 / 50), rel=0.03)
    assert (found.images / found.sigma).std() == pytest.approx(1.0, abs=0.02)


def test_drift_and_jitter_stay_out_of_a_coded_stack_where_plain_averaging_lets_texture_in():
    rng = np.random.default_rng(3)
    leds = coded_sequence(4, 100)
    ground = background_e(rng, SHAPE, 0.10)
    along_v, along_u = np.gradient(ground)
    frames = np.stack(
        [
            expose(rng, (ground - (0.2 * t + jitter[0]) * along_u - jitter[1] * along_v) * (1 + 0.02 * t))
            for t, jitter in zip(np.linspace(0, 1, 200), 0.05 * rng.standard_normal((200, 2)), strict=True)
        ]
    )
    theory = noise_counts() * np.sqrt(2 / 100)
    first_half = frames[:100].mean(axis=0) - frames[100:].mean(axis=0)
    assert first_half.std() > 5 * theory
    assert stacked(leds, frames).difference().images.std() == pytest.approx(theory, rel=0.05)


def test_a_stack_does_not_grow_with_its_frames():
    rng = np.random.default_rng(4)
    leds = coded_sequence(4, 32)
    frames = sequence(rng, background_e(rng, SHAPE), leds, {})
    stack = Stack(4, noise_counts())

    def held():
        return sum(value.nbytes for value in vars(stack).values() if isinstance(value, np.ndarray))

    stack.add(frames, leds)
    after_one = held()
    for _ in range(4):
        stack.add(frames, leds)
    assert held() == after_one
    assert stack.pairs == 160


def test_a_frame_of_another_scene_is_reported():
    rng = np.random.default_rng(5)
    leds = coded_sequence(4, 32)
    frames = sequence(rng, background_e(rng, SHAPE), leds, {})
    frames[20] = np.roll(frames[20], 9, axis=1)
    assert "shift" in stacked(leds, frames).problem


def test_stacks_refuse_frames_without_masks_and_questions_before_frames():
    stack = Stack(4, noise_counts())
    with pytest.raises(ValueError, match=r"got shape \(3, 60, 90\), expected \(2, height, width\)"):
        stack.add(np.zeros((3, *SHAPE), np.uint16), (1, 2))
    with pytest.raises(ValueError, match="got no frames yet"):
        stack.difference()
