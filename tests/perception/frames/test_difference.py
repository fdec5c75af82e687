"""Difference images and the comparison of frames."""

import numpy as np
import pytest

from perception.frames.difference import difference, led_sequence, pair_weights
from perception.frames.similarity import compare
from tests.perception.synthetic import GAIN_E, background_e, noise_counts, sequence, spot

SHAPE = (96, 110)


def images(rng, pairs=4, light=None, power=3e4, texture=0.08):
    leds = led_sequence(4, pairs)
    spots = {m: power * spot(SHAPE, 30.0 + 15 * m, 40.0, 3.0) for m in range(4)}
    return leds, sequence(rng, background_e(rng, SHAPE, texture), leds, spots, light)


def test_a_sequence_has_a_reference_before_each_cycle_and_at_the_end():
    assert led_sequence(4, 2) == (0, 1, 2, 4, 8, 0, 1, 2, 4, 8, 0)


def test_weights_of_a_difference_cancel_a_linear_drift():
    leds = led_sequence(4, 3)
    W = pair_weights(leds, 4)
    np.testing.assert_allclose(W @ np.ones(len(leds)), 0, atol=1e-12)
    np.testing.assert_allclose(W @ np.arange(len(leds)), 0, atol=1e-12)


def test_each_difference_image_holds_its_own_marker_only():
    leds, stack = images(np.random.default_rng(1), pairs=8)
    found = difference(compare(stack, noise_counts()).frames, leds, 4, noise_counts())
    for m in range(4):
        around = found.images[:, 36:45, 26 + 15 * m : 35 + 15 * m].sum(axis=(1, 2))
        assert around[m] == pytest.approx(3e4 / GAIN_E, rel=0.15)
        assert np.abs(np.delete(around, m)).max() < 0.15 * around[m]


def test_reported_noise_is_the_noise():
    rng = np.random.default_rng(2)
    for pairs in (1, 5):
        leds, stack = images(rng, pairs=pairs, power=0.0, texture=0.0)
        found = difference(compare(stack, noise_counts()).frames, leds, 4, noise_counts())
        assert (found.images / found.sigma).std() == pytest.approx(1.0, abs=0.03)


def test_a_drift_of_light_leaves_no_texture_behind():
    rng = np.random.default_rng(3)
    leds = led_sequence(4, 6)
    drift = 1 + 0.04 * np.sin(np.linspace(0, 3, len(leds)))
    _, stack = images(rng, pairs=6, light=drift, power=0.0)
    found = difference(compare(stack, noise_counts()).frames, leds, 4, noise_counts())
    plain = noise_counts() * np.linalg.norm(pair_weights(leds, 4), axis=1)
    assert (found.images.std(axis=(1, 2)) < 1.1 * plain).all()


def test_a_steady_scene_is_comparable():
    _, stack = images(np.random.default_rng(4))
    assert compare(stack, noise_counts()).problem == ""


def test_a_strong_marker_does_not_pass_for_a_change_of_light():
    _, stack = images(np.random.default_rng(4), power=1.5e6, texture=0.02)
    found = compare(stack, noise_counts())
    assert found.problem == ""
    assert np.abs(found.gain).max() < 0.05


def test_a_jolted_frame_is_told_and_found():
    _, stack = images(np.random.default_rng(5))
    stack[7] = np.roll(stack[7], 8, axis=1)
    found = compare(stack, noise_counts())
    assert found.problem
    assert int(found.rest_counts.argmax()) == 7


def test_a_frame_off_by_pixels_is_brought_back():
    _, stack = images(np.random.default_rng(5))
    stack[7] = np.roll(stack[7], 2, axis=1)
    found = compare(stack, noise_counts())
    assert found.problem == ""
    assert found.shift_px[7, 0] - found.shift_px[6, 0] == pytest.approx(2.0, abs=0.1)
    assert found.unknown_px > 0


def test_a_small_quiver_is_taken_out():
    rng = np.random.default_rng(6)
    ground = background_e(rng, (SHAPE[0], SHAPE[1] + 1))
    quiver = 0.3 * rng.standard_normal(21)
    frames = [
        sequence(rng, (1 - abs(q)) * ground[:, :-1] + abs(q) * ground[:, 1:], (0,), {})[0] for q in quiver
    ]
    found = compare(np.stack(frames), noise_counts())
    assert found.problem == ""
    raw = np.stack(frames).std(axis=0, ddof=1).mean()
    left = found.frames.std(axis=0, ddof=1).mean()
    assert left == pytest.approx(noise_counts(), rel=0.03)
    assert raw > 1.2 * left


def test_a_change_of_light_by_a_fifth_is_told():
    rng = np.random.default_rng(7)
    light = np.ones(21)
    light[10:] = 1.25
    _, stack = images(rng, light=light)
    assert "change of contrast" in compare(stack, noise_counts()).problem


def test_another_scene_in_one_frame_is_told():
    rng = np.random.default_rng(8)
    _, stack = images(rng)
    stack[3] = sequence(rng, background_e(rng, SHAPE), (0,), {})[0]
    assert "unexplained difference" in compare(stack, noise_counts()).problem


@pytest.mark.parametrize("shape", [(1, 40, 40), (5, 4, 40), (40, 40)])
def test_comparison_refuses_wrong_shapes(shape):
    with pytest.raises(ValueError, match="stack: got shape"):
        compare(np.zeros(shape, dtype=np.uint16), 1.7)


def test_sequences_without_reference_or_with_two_leds_at_once_are_refused():
    with pytest.raises(ValueError, match="without a dark frame"):
        pair_weights((1, 2, 4, 8), 4)
    with pytest.raises(ValueError, match="frame 1: got LED mask 0b11"):
        pair_weights((0, 3), 4)
    with pytest.raises(ValueError, match="0 pairs"):
        led_sequence(4, 0)
    with pytest.raises(ValueError, match="frames: got shape"):
        difference(np.zeros((3, 20, 20), dtype=np.float32), (0, 1), 4, 1.7)
