"""Linear guess, iteration, covariance: against truth and against the Cramer-Rao bound."""

import numpy as np
import pytest
from scipy.stats import chi2

from executive.core.rig import CabinCalibration, HeadCalibration, RigCalibration
from perception.geometry.body import Transform
from perception.geometry.camera import triangulate
from perception.geometry.chain import Chain
from perception.geometry.pose import (
    Prior,
    Sighting,
    estimate,
    guess_body,
    linear_guess,
    roll_pitch,
)
from perception.geometry.rotation import exp_map, log_map
from tests.perception.synthetic import scene
from tests.perception.trials import run

PAIRS = {1.6: 1, 2.0: 2, 3.0: 6, 4.0: 14, 5.0: 30}
EXACT_RIG = RigCalibration(
    head=HeadCalibration(pan_accuracy_rad=0.0, tilt_accuracy_rad=0.0),
    cabin=CabinCalibration(joint_sigma_rad=0.0),
)
PLATE = np.array(RigCalibration().markers.positions_plc_m)


def sighting(true, sigma_px=0.1, rng=None, hidden=(), with_tilt=True):
    uv = true.uv_px.copy()
    if rng is not None:
        uv = uv + sigma_px * rng.standard_normal(uv.shape)
    uv[:, list(hidden)] = np.nan
    covariance = np.broadcast_to(sigma_px**2 * np.eye(2), (2, 4, 2, 2))
    tilt = None
    if with_tilt:
        sigma = true.chain.rig.rover.inclinometer_sigma_rad
        noise = np.zeros(2) if rng is None else sigma * rng.standard_normal(2)
        tilt = tuple(roll_pitch(true.state.site_body.rotation)[0] + noise)
    return Sighting(uv, covariance, true.state.head_rad, true.state.joints_rad, tilt)


def error(fix, true):
    body, truth = fix.state.site_body, true.state.site_body
    return np.concatenate([truth.position_m - body.position_m, log_map(truth.rotation @ body.rotation.T)])


@pytest.mark.parametrize("markers", [[0, 1, 2, 3], [0, 1, 2], [1, 2, 3]])
def test_linear_guess_is_exact_without_noise(markers):
    truth = Transform(exp_map(np.array([0.3, -0.5, 1.2])), np.array([3.0, 0.2, -0.4]))
    guess = linear_guess(truth.apply(PLATE[markers]), PLATE[markers])
    np.testing.assert_allclose(guess.rotation, truth.rotation, atol=1e-12)
    np.testing.assert_allclose(guess.position_m, truth.position_m, atol=1e-12)


def test_linear_guess_is_a_rotation_whatever_the_noise():
    rng = np.random.default_rng(1)
    for _ in range(50):
        R = linear_guess(PLATE + 0.05 * rng.standard_normal(PLATE.shape), PLATE).rotation
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("points", "plate", "complaint"),
    [
        (PLATE * np.nan, PLATE, "12 non-finite values|points_m: got"),
        (PLATE[:2], PLATE[:2], "2 markers on one line"),
        (PLATE[[0, 0, 1]], PLATE[[0, 0, 1]], "3 markers on one line"),
        (PLATE, PLATE + np.array([0, 0, 0.1]), "z other than 0"),
        (PLATE, PLATE[:3], r"markers_plc_m: got shape \(3, 3\), expected \(4, 3\)"),
        (PLATE[:0], PLATE[:0], r"points_m: got shape \(0, 3\), expected \(n, 3\)"),
    ],
)
def test_linear_guess_refuses_what_it_cannot_solve(points, plate, complaint):
    with pytest.raises(ValueError, match=complaint):
        linear_guess(points, plate)


# Flat rover, tilt zero: where the ZXZ angles of the paper's eq. 8 are singular; then steep and turned ones.
@pytest.mark.parametrize("turn", [(0, 0, 0), (0, 0, np.pi), (0, 0, 3.0), (0.3, -0.2, 2.2), (1e-9, 0, 1.5)])
def test_noise_free_pose_is_exact_at_any_attitude(turn):
    true = scene(3.0, turn, (0.2, 0.1))
    measured = sighting(true)
    points = triangulate(true.chain.model, measured.uv_px)
    fix = estimate(true.chain, measured, guess_body(true.chain, points, measured, [0, 1, 2, 3]))
    assert np.abs(error(fix, true)).max() < 1e-7
    assert fix.converged
    assert fix.chi2 < 1e-6


def test_iteration_recovers_from_a_start_far_away():
    true = scene(3.0)
    far = Transform(
        exp_map(np.array([0.2, -0.2, 1.8])), true.state.site_body.position_m + np.array([0.4, -0.3, 0.2])
    )
    assert np.abs(error(estimate(true.chain, sighting(true), far), true)).max() < 1e-7


@pytest.mark.parametrize("hidden", [(), (1,), (0, 2)])
def test_covariance_is_true_with_markers_missing(hidden):
    """Mean NEES over 200 fixes within its 95 % band, with 4, 3 and 2 markers."""
    rng, nees = np.random.default_rng(5), []
    true = scene(3.0, rig=EXACT_RIG)
    for _ in range(200):
        fix = estimate(true.chain, sighting(true, 0.15, rng, hidden), true.state.site_body)
        np.linalg.cholesky(fix.covariance)
        off = error(fix, true)
        nees.append(off @ np.linalg.solve(fix.covariance, off))
    low, high = chi2.ppf((0.025, 0.975), 6 * 200) / 200
    assert low < np.mean(nees) < high


def test_two_markers_need_inclinometers_for_roll_and_pitch():
    true = scene(3.0, rig=EXACT_RIG)
    with_tilt = estimate(true.chain, sighting(true, hidden=(0, 2)), true.state.site_body)
    measured = sighting(true, hidden=(0, 2), with_tilt=False)
    prior = Prior(true.state.site_body, np.diag([0.02] * 3 + [0.05] * 3) ** 2)
    with_prior = estimate(true.chain, measured, true.state.site_body, prior)
    assert with_tilt.covariance[3:, 3:].max() < with_prior.covariance[3:, 3:].max()


def test_a_prior_narrows_a_fix_and_a_wide_one_does_not():
    true = scene(5.0)
    plain = estimate(true.chain, sighting(true), true.state.site_body)
    wide = Prior(true.state.site_body, np.eye(6) * 1e4)
    tight = Prior(true.state.site_body, np.eye(6) * 1e-8)
    same = estimate(true.chain, sighting(true), true.state.site_body, wide)
    np.testing.assert_allclose(same.covariance, plain.covariance, rtol=1e-3, atol=1e-12)
    narrowed = estimate(true.chain, sighting(true), true.state.site_body, tight)
    assert np.trace(narrowed.covariance) < 0.1 * np.trace(plain.covariance)


def test_chi_square_tells_a_wrong_centre():
    true = scene(3.0)
    measured = sighting(true, 0.1, np.random.default_rng(6))
    assert estimate(true.chain, measured, true.state.site_body).consistent()
    measured.uv_px[0, 2] += [4.0, -3.0]
    assert not estimate(true.chain, measured, true.state.site_body).consistent()


def test_too_few_marks_or_wrong_shapes_are_refused():
    true = scene(3.0)
    measured = sighting(true, hidden=(0, 1, 2), with_tilt=False)
    measured.uv_px[1] = np.nan
    with pytest.raises(ValueError, match="got 1 marker images, expected enough"):
        estimate(true.chain, measured, true.state.site_body)
    wrong = Sighting(np.zeros((2, 3, 2)), measured.covariance_px2, (0, 0), (0, 0))
    with pytest.raises(ValueError, match=r"uv_px: got shape \(2, 3, 2\), expected \(2, 4, 2\)"):
        estimate(true.chain, wrong, true.state.site_body)


def test_inclinometer_readings_follow_the_axes():
    """Roll about x raises the left side; pitch about y lowers the nose."""
    assert roll_pitch(exp_map(np.array([0.2, 0, 0])))[0] == pytest.approx([0.2, 0.0])
    assert roll_pitch(exp_map(np.array([0, 0.3, 0])))[0] == pytest.approx([0.0, 0.3])
    R = exp_map(np.array([0.1, -0.2, 2.0]))
    for k, step in enumerate(np.eye(3) * 1e-6):
        rise = roll_pitch(exp_map(step) @ R)[0] - roll_pitch(exp_map(-step) @ R)[0]
        np.testing.assert_allclose(roll_pitch(R)[1][:, k], rise / 2e-6, atol=1e-8)


def assert_meets_bound(campaign, ratio):
    assert len(campaign.errors) >= 0.99 * campaign.tried
    assert campaign.position_ratio < ratio
    assert campaign.yaw_ratio < ratio
    count = campaign.nees.size
    low, high = chi2.ppf((0.025, 0.975), 6 * count) / count
    assert low < campaign.nees.mean() < high


@pytest.mark.parametrize("range_m", [1.6, 3.0, 5.0])
def test_pose_from_images_meets_the_bound(range_m):
    true = scene(range_m, rig=EXACT_RIG)
    assert_meets_bound(run(true, PAIRS[range_m], 80, np.random.default_rng(11)), 1.3)


@pytest.mark.slow
@pytest.mark.parametrize("rig", [EXACT_RIG, RigCalibration()], ids=["exact head", "real head"])
@pytest.mark.parametrize("range_m", list(PAIRS))
def test_pose_from_many_image_sets_meets_the_bound(range_m, rig):
    """`benchmarks/pose_bound.py` takes 500 of each."""
    true = scene(range_m, rig=rig)
    assert_meets_bound(run(true, PAIRS[range_m], 100, np.random.default_rng([12, PAIRS[range_m]])), 1.3)


def test_chain_of_the_default_rig_has_four_markers():
    assert Chain.of(RigCalibration()).markers_plc_m.shape == (4, 3)
