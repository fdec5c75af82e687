"""Missing markers, reflections, swaps: what is accepted is true, or nothing is accepted."""

import numpy as np
import pytest

from perception.geometry.pose import Prior, roll_pitch
from perception.geometry.rotation import log_map
from perception.markers.centres import Detection
from perception.markers.marker_fix import MarkerFix, Rejection
from perception.markers.plausibility import choose
from tests.perception.synthetic import scene

SIGMA_PX = 0.15


def detections(true, rng, flux=10.0):
    def one(uv, flux=flux):
        centre = uv + SIGMA_PX * rng.standard_normal(2)
        return Detection(centre, SIGMA_PX**2 * np.eye(2), flux * (1 + 0.1 * rng.standard_normal()), flux / 10)

    return [[[one(true.uv_px[c, m])] for m in range(4)] for c in (0, 1)]


def stray(rng, near_px, flux=9.0, reach=60.0):
    return Detection(near_px + rng.uniform(-reach, reach, 2), SIGMA_PX**2 * np.eye(2), flux, flux / 9)


def chosen(true, candidates, rng, prior_sigma=(0.03, 0.1)):
    tilt = tuple(roll_pitch(true.state.site_body.rotation)[0] + 0.0017 * rng.standard_normal(2))
    prior = Prior(true.state.site_body, np.diag([prior_sigma[0]] * 3 + [prior_sigma[1]] * 3) ** 2)
    return choose(true.chain, candidates, true.state.head_rad, true.state.joints_rad, tilt, prior)


def is_true(fix, true):
    """Within six of its own standard deviations of the truth, in place and heading."""
    body, truth = fix.fit.state.site_body, true.state.site_body
    turn = log_map(truth.rotation @ body.rotation.T)
    off = np.concatenate([truth.position_m - body.position_m, turn])
    return off @ np.linalg.solve(fix.fit.covariance, off) < 36


@pytest.fixture
def true():
    return scene(3.0)


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def test_four_clean_markers_are_taken_at_the_first_set(true, rng):
    fix = chosen(true, detections(true, rng), rng)
    assert isinstance(fix, MarkerFix)
    assert fix.markers == 4
    assert is_true(fix, true)


@pytest.mark.parametrize("missing", [(0,), (3,), (0, 1), (1, 3)])
def test_missing_markers_are_done_without(true, rng, missing):
    candidates = detections(true, rng)
    for m in missing:
        candidates[0][m] = []
    fix = chosen(true, candidates, rng)
    assert isinstance(fix, MarkerFix)
    assert set(fix.shining) == set(range(4)) - set(missing)
    assert is_true(fix, true)


def test_one_marker_is_too_few(true, rng):
    candidates = detections(true, rng)
    for m in (0, 1, 2):
        candidates[1][m] = []
    result = chosen(true, candidates, rng)
    assert isinstance(result, Rejection)
    assert result.seen == 1
    assert "1 of 4 markers seen by both cameras" in result.why


def test_brighter_reflections_beside_true_markers_are_passed_over(true):
    """A glint on the same line of sight heights in both cameras, brighter than the marker."""
    for seed in range(25):
        rng = np.random.default_rng(seed)
        candidates = detections(true, rng)
        for m in rng.choice(4, 2, replace=False):
            shift = rng.uniform(15, 60, 2)
            for c in (0, 1):
                glint = Detection(true.uv_px[c, m] + shift, SIGMA_PX**2 * np.eye(2), 20.0, 1.0)
                candidates[c][m].insert(0, glint)
        fix = chosen(true, candidates, rng)
        assert isinstance(fix, MarkerFix)
        assert fix.markers == 4
        assert is_true(fix, true)


def test_a_reflection_in_place_of_a_marker_never_gives_a_false_pose(true):
    accepted = 0
    for seed in range(40):
        rng = np.random.default_rng(100 + seed)
        candidates = detections(true, rng)
        m = int(rng.integers(4))
        shift = rng.uniform(4, 40, 2) * rng.choice([-1, 1], 2)
        for c in (0, 1):
            candidates[c][m] = [Detection(true.uv_px[c, m] + shift, SIGMA_PX**2 * np.eye(2), 8.0, 1.0)]
        fix = chosen(true, candidates, rng)
        if isinstance(fix, MarkerFix):
            accepted += 1
            assert is_true(fix, true)
            assert m not in set(fix.shining)
    assert accepted >= 36


def test_an_outlier_in_one_camera_never_gives_a_false_pose(true):
    for seed in range(40):
        rng = np.random.default_rng(200 + seed)
        candidates = detections(true, rng)
        c, m = int(rng.integers(2)), int(rng.integers(4))
        candidates[c][m] = [stray(rng, true.uv_px[c, m])]
        fix = chosen(true, candidates, rng)
        assert isinstance(fix, MarkerFix)
        assert is_true(fix, true)


@pytest.mark.parametrize("pair", [(0, 1), (1, 2), (0, 2), (1, 3)])
@pytest.mark.parametrize("prior_sigma", [(0.03, 0.1), (0.5, 1.0)])
def test_a_swapped_identity_never_gives_a_false_pose(true, rng, pair, prior_sigma):
    candidates = detections(true, rng)
    a, b = pair
    for c in (0, 1):
        candidates[c][a], candidates[c][b] = candidates[c][b], candidates[c][a]
    fix = chosen(true, candidates, rng, prior_sigma)
    if isinstance(fix, MarkerFix):
        assert is_true(fix, true)
        assert fix.note == f"LEDs swapped: {a} with {b}"


def test_noise_alone_is_rejected(true):
    for seed in range(20):
        rng = np.random.default_rng(300 + seed)
        candidates = [
            [[stray(rng, true.uv_px[c, m], reach=80) for _ in range(3)] for m in range(4)] for c in (0, 1)
        ]
        result = chosen(true, candidates, rng)
        assert isinstance(result, Rejection) or is_true(result, true)
