"""Motion fragments: what moved between two frames of one camera, of a synthetic box on textured ground."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, shift

from perception.frames.steadying import lay_onto
from perception.outline.motion import motion_fragments
from tests.perception.synthetic import background_e, expose, noise_counts

SHAPE = (300, 420)


def moving_box(rng, middle, step, vibration=(0.0, 0.0), light=1.0, size=(60, 110), shadow=0):
    """Two frames: a textured box at `middle` (u, v) in the second one, `step` px on from the first.

    `shadow` is how far to the right of it its shadow falls.
    """
    ground = background_e(rng, SHAPE)
    skin = 0.5 * background_e(rng, size, 0.2)

    def view(u, v):
        picture = ground.copy()
        top, left = round(v - size[0] / 2), round(u - size[1] / 2)
        picture[top + 20 : top + size[0], left + size[1] : left + size[1] + shadow] *= 0.2
        picture[top : top + size[0], left : left + size[1]] = skin
        return picture

    first = view(middle[0] - step[0], middle[1] - step[1])
    second = shift(view(*middle), vibration[::-1], order=3, mode="nearest") * light
    return expose(rng, first), expose(rng, second)


def covers(region, middle, size=(60, 110), slack=16):
    """Whether a region holds the box and not much more."""
    low = np.array([region.u, region.v]) - (middle[0] - size[1] / 2, middle[1] - size[0] / 2)
    high = low + np.array([region.width - size[1], region.height - size[0]])
    return bool((np.abs(low) < slack).all() and (np.abs(high) < slack).all())


@pytest.mark.parametrize("seed", range(5))
def test_the_region_bounds_what_moved(seed):
    rng = np.random.default_rng(seed)
    found = motion_fragments(*moving_box(rng, (210, 150), (8, 4)), noise_counts())
    assert covers(found.region, (210, 150))


@pytest.mark.parametrize("vibration", [(3.0, -2.0), (-6.5, 4.0), (0.4, 0.3)])
@pytest.mark.parametrize("light", [0.9, 1.0, 1.03])
def test_vibration_and_another_light_are_taken_out(vibration, light):
    rng = np.random.default_rng(9)
    found = motion_fragments(*moving_box(rng, (210, 150), (8, 4), vibration, light), noise_counts())
    assert found.shaken_px == pytest.approx(vibration, abs=0.15)
    assert covers(found.region, np.add((210, 150), vibration))


def test_a_box_at_rest_leaves_no_fragments():
    for seed in range(10):
        rng = np.random.default_rng(seed)
        frames = moving_box(rng, (210, 150), (0, 0), (2.0, 1.0))
        found = motion_fragments(*frames, noise_counts())
        assert found is None or found.area_px < 60


def test_where_everything_moved_nothing_is_said():
    rng = np.random.default_rng(8)
    here, there = (expose(rng, background_e(rng, SHAPE)) for _ in range(2))
    assert motion_fragments(here, there, noise_counts()) is None


def test_specks_far_from_the_rover_do_not_widen_the_region():
    rng = np.random.default_rng(3)
    before, after = moving_box(rng, (120, 150), (8, 4))
    after[20:26, 390:396] += 200
    found = motion_fragments(before, after, noise_counts(), reach_px=120)
    assert found.region.u + found.region.width < 300


def test_the_region_is_in_full_frame_pixels():
    rng = np.random.default_rng(4)
    frames = moving_box(rng, (210, 150), (8, 4))
    here, there = (motion_fragments(*frames, noise_counts(), corner) for corner in ((0, 0), (300, 400)))
    assert (there.region.u, there.region.v) == (here.region.u + 300, here.region.v + 400)


def test_binned_frames_show_the_same_region_in_full_pixels():
    rng = np.random.default_rng(4)
    found = motion_fragments(*moving_box(rng, (210, 150), (8, 4), (1.0, 2.0)), noise_counts(), binning=3)
    assert found.edges.shape == (100, 140)
    assert found.shaken_px == pytest.approx((1.0, 2.0), abs=0.2)
    assert covers(found.region, (211, 152), slack=24)


def test_frames_of_unequal_or_tiny_shape_are_refused():
    with pytest.raises(ValueError, match="got frames of shape"):
        motion_fragments(np.zeros((40, 40), np.uint16), np.zeros((40, 41), np.uint16), 1.7)
    with pytest.raises(ValueError, match="got frames of shape"):
        motion_fragments(np.zeros((4, 4), np.uint16), np.zeros((4, 4), np.uint16), 1.7)
    with pytest.raises(ValueError, match="96 or more"):
        motion_fragments(np.zeros((64, 64), np.uint16), np.zeros((64, 64), np.uint16), 1.7, binning=3)


def test_noise_alone_leaves_next_to_nothing():
    rng = np.random.default_rng(6)
    flat = gaussian_filter(np.full(SHAPE, 64000.0), 1)
    for _ in range(20):
        found = motion_fragments(expose(rng, flat), expose(rng, flat), noise_counts())
        assert found is None or found.area_px < 60


@pytest.mark.parametrize("level", [0, 1023, 65535])
def test_frames_that_show_nothing_leave_nothing(level):
    blank = np.full(SHAPE, level, np.uint16)
    assert motion_fragments(blank, blank, noise_counts()) is None


def test_a_frame_is_laid_to_a_twentieth_of_a_pixel_although_a_part_of_it_moved():
    rng = np.random.default_rng(2)
    before, after = moving_box(rng, (210, 150), (8, 4), (2.3, -1.6), 1.05, shadow=80)
    laid = lay_onto(before.astype(np.float32), after.astype(np.float32))
    assert laid.shift_px == pytest.approx((2.3, -1.6), abs=0.05)
    ground = np.s_[20:80, 20:400]
    assert np.std(laid.counts[ground] - before[ground]) < 2.5 * noise_counts()
