"""Motion fragments of a synthetic moving rover."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, shift

from executive.rig import RigCalibration
from perception.camera import StereoModel
from perception.motion import coarse_position, motion_fragments
from tests.perception.synthetic import background_e, expose, noise_counts

SHAPE = (300, 420)


def moving_rover(rng, middle, step, vibration=(0.0, 0.0), light=1.0, size=(60, 110)):
    """Two frames: a textured box at `middle` (u, v) in the second one, `step` px on from the first."""
    ground = background_e(rng, SHAPE)
    skin = 0.5 * background_e(rng, size, 0.2)

    def view(u, v, ground):
        picture = ground.copy()
        top, left = round(v - size[0] / 2), round(u - size[1] / 2)
        picture[top : top + size[0], left : left + size[1]] = skin
        return picture

    first = view(middle[0] - step[0], middle[1] - step[1], ground)
    second = shift(view(*middle, ground), vibration[::-1], order=1, mode="nearest") * light
    return expose(rng, first), expose(rng, second)


@pytest.mark.parametrize("seed", range(5))
def test_the_latest_middle_is_found_within_a_fifth_of_the_rover(seed):
    rng = np.random.default_rng(seed)
    found = motion_fragments(*moving_rover(rng, (210, 150), (20, 4)), noise_counts())
    assert np.hypot(found.latest_px[0] - 210, found.latest_px[1] - 150) < 22
    assert found.shift_px == pytest.approx((20, 4), abs=3)


@pytest.mark.parametrize("vibration", [(3.0, -2.0), (-6.5, 4.0), (0.4, 0.3)])
def test_vibration_of_the_head_is_forgiven(vibration):
    rng = np.random.default_rng(9)
    found = motion_fragments(*moving_rover(rng, (210, 150), (20, 4), vibration, 1.03), noise_counts())
    expected = np.array([210, 150]) + vibration
    assert np.hypot(*(found.latest_px - expected)) < 25


def test_a_rover_at_rest_leaves_no_fragments():
    for seed in range(10):
        rng = np.random.default_rng(seed)
        assert motion_fragments(*moving_rover(rng, (210, 150), (0, 0), (2.0, 1.0)), noise_counts()) is None


def test_specks_far_from_the_rover_are_left_out():
    rng = np.random.default_rng(3)
    before, after = moving_rover(rng, (120, 150), (20, 4))
    after[20:26, 390:396] += 200
    found = motion_fragments(before, after, noise_counts(), reach_px=120)
    assert found.region.u + found.region.width < 300


def test_the_region_is_in_full_frame_pixels():
    rng = np.random.default_rng(4)
    frames = moving_rover(rng, (210, 150), (20, 4))
    here, there = (motion_fragments(*frames, noise_counts(), corner) for corner in ((0, 0), (300, 400)))
    assert (there.region.u, there.region.v) == (here.region.u + 300, here.region.v + 400)
    assert there.centre_px == pytest.approx((here.centre_px[0] + 300, here.centre_px[1] + 400))


def test_frames_of_unequal_or_tiny_shape_are_refused():
    with pytest.raises(ValueError, match="got frames of shape"):
        motion_fragments(np.zeros((40, 40), np.uint16), np.zeros((40, 41), np.uint16), 1.7)
    with pytest.raises(ValueError, match="got frames of shape"):
        motion_fragments(np.zeros((4, 4), np.uint16), np.zeros((4, 4), np.uint16), 1.7)


@pytest.mark.parametrize("blind", [None, 0, 1])
def test_coarse_position_on_a_known_height_is_true_to_its_covariance(blind):
    rng, model = np.random.default_rng(5), StereoModel.of(RigCalibration())
    normal, truth, nees = np.array([0.0, 0.0, 1.0]), np.array([3.0, 0.1, -0.4]), []
    normal = np.array([-np.sin(0.4), 0.0, np.cos(0.4)])
    for _ in range(300):
        uv = model.project(truth[None])[:, 0] + 8.0 * rng.standard_normal((2, 2))
        if blind is not None:
            uv[blind] = np.nan
        height = float(normal @ truth + 0.03 * rng.standard_normal())
        point, P = coarse_position(model, uv, np.full(2, 8.0), (normal, height, 0.03))
        nees.append((point - truth) @ np.linalg.solve(P, point - truth))
    assert np.mean(nees) == pytest.approx(3.0, abs=0.5)


def test_coarse_position_needs_one_camera():
    with pytest.raises(ValueError, match="NaN for both cameras"):
        coarse_position(
            StereoModel.of(RigCalibration()),
            np.full((2, 2), np.nan),
            np.ones(2),
            (np.array([0, 0, 1.0]), 0.0, 1.0),
        )


def test_blobs_of_pure_noise_are_rare():
    rng = np.random.default_rng(6)
    flat = gaussian_filter(np.full(SHAPE, 64000.0), 1)
    hits = sum(
        motion_fragments(expose(rng, flat), expose(rng, flat), noise_counts()) is not None for _ in range(20)
    )
    assert hits == 0
