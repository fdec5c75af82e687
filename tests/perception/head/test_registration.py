"""Two pictures of the ground: planted shifts are recovered, other ground is not recognised."""

import cv2
import numpy as np
import pytest

from perception.head.registration import register

SIZE, NOISE = 640, 1.7


def ground(seed: int) -> np.ndarray:
    """Counts of textured ground, larger than a frame."""
    rng = np.random.default_rng(seed)
    fine, coarse = (cv2.GaussianBlur(rng.standard_normal((900, 900)), (0, 0), s) * s for s in (2, 8))
    return 400 + 40 * fine + 60 * coarse


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def frame(counts: np.ndarray, du: float, dv: float, turn_deg: float = 0.0, seed: int = 0) -> np.ndarray:
    """The middle of the ground, moved by (du, dv) and turned about the frame's middle, with noise."""
    M = cv2.getRotationMatrix2D((450, 450), turn_deg, 1.0)
    M[:, 2] += (du, dv)
    moved = cv2.warpAffine(counts, M, (900, 900), flags=cv2.INTER_CUBIC)
    cut = moved[130 : 130 + SIZE, 130 : 130 + SIZE]
    return (cut + NOISE * np.random.default_rng(seed).standard_normal(cut.shape)).astype(np.float32)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, -0.4), (5.25, 17.5), (-80.6, 33.3)])
def test_a_planted_shift_is_found_to_a_tenth_of_a_pixel(shift):
    counts = ground(1)
    found = register(frame(counts, 0, 0, seed=1), frame(counts, *shift, seed=2), NOISE)
    moved = found.after_px - found.before_px
    assert len(moved) > 25
    right = np.abs(moved - shift).max(axis=1) < 1.0  # what has left the picture may resemble something else
    assert right.mean() > 0.9
    assert rms((moved - shift)[right]) < 0.1


def test_a_turned_picture_moves_each_patch_by_its_own():
    counts = ground(2)
    found = register(frame(counts, 0, 0), frame(counts, 0, 0, turn_deg=1.0, seed=2), NOISE)
    middle = 450 - 130
    arm = found.before_px - middle
    c, s = np.cos(np.radians(1.0)), np.sin(np.radians(1.0))
    expected = middle + arm @ np.array([[c, s], [-s, c]]).T
    assert np.median(np.abs(found.after_px - expected)) < 0.1


@pytest.mark.parametrize(("gain", "offset"), [(0.2, 0.0), (1.0, 300.0), (1.6, -150.0)])
def test_other_light_changes_nothing(gain, offset):
    counts = ground(3)
    dimmed = gain * frame(counts, 2.5, -1.5, seed=2) + np.float32(offset)
    found = register(frame(counts, 0, 0), dimmed, NOISE)
    assert rms(found.after_px - found.before_px - (2.5, -1.5)) < 0.1


def test_shadows_that_sweep_over_part_of_the_ground_leave_the_rest():
    counts = ground(4)
    shadowed = frame(counts, 1.0, 1.0, seed=2)
    shadowed[:, :250] *= np.linspace(0.2, 1.0, 250, dtype=np.float32)
    found = register(frame(counts, 0, 0), shadowed, NOISE)
    assert np.median(np.abs(found.after_px - found.before_px - 1.0)) < 0.1


def test_other_ground_is_hardly_recognised():
    found = register(frame(ground(5), 0, 0), frame(ground(6), 0, 0, seed=2), NOISE)
    assert len(found.before_px) < 4


def test_ground_without_texture_gives_nothing_to_hold_on_to():
    bare = np.full((SIZE, SIZE), 400, dtype=np.float32)
    noise = NOISE * np.random.default_rng(1).standard_normal(bare.shape).astype(np.float32)
    assert len(register(bare + noise, bare - noise, NOISE).before_px) == 0


def test_pictures_of_different_shape_are_refused():
    with pytest.raises(ValueError, match=r"expected two alike"):
        register(np.zeros((640, 640), np.float32), np.zeros((640, 500), np.float32), NOISE)
