"""Joint detection: what no marker shows by itself, all of them show together; and the bounds it keeps."""

from dataclasses import replace

import numpy as np
import pytest

from executive.core.rig import RigCalibration, SensorCalibration
from perception.frames.exposure import PlateView, flux_expected
from perception.frames.psf import marker_spread
from perception.markers.fisher import (
    centre_bound,
    centre_bounds,
    pose_bound,
    surface_bound,
)
from tests.perception.far_trials import Nuisance, draw, run_trial


@pytest.mark.parametrize(
    ("range_m", "bound_px"), [(1.6, 0.188), (5.0, 0.45), (7.5, 0.79), (10.0, 1.28), (15.0, 2.7), (20.0, 4.65)]
)
def test_the_bound_of_a_centre_is_what_others_computed_for_this_rig_without_defocus(range_m, bound_px):
    sharp = replace(RigCalibration(), sensor=SensorCalibration(defocus_px_m=0.0))
    flux, noise = flux_expected(sharp, PlateView(range_m, 1.0)), np.sqrt(2.0) * sharp.sensor.noise_counts
    places = np.random.default_rng(0).uniform(-0.5, 0.5, (100, 2))
    bounds = [centre_bound(marker_spread(sharp, range_m), flux, noise, place)[0, 0] for place in places]
    assert np.sqrt(np.mean(bounds)) == pytest.approx(bound_px, rel=0.05)


def test_bounds_fall_with_pairs_and_with_what_is_known_of_the_ground():
    setting = draw(15.0, np.random.default_rng(1), RigCalibration())
    chain, state = setting.true.chain, setting.said
    np.testing.assert_allclose(centre_bounds(chain, state, 100.0) * 4, centre_bounds(chain, state, 25.0))
    free = pose_bound(chain, state, centre_bounds(chain, state, 100.0))
    soft, hard = (surface_bound(chain, state, 100.0, height) for height in (0.02, 0.001))
    assert np.trace(hard[:2, :2]) < np.trace(soft[:2, :2]) < np.trace(free[:2, :2])
    assert soft[2, 2] <= free[5, 5] * (1 + 1e-9)


@pytest.mark.parametrize(("range_m", "pairs"), [(7.5, 20), (20.0, 300)])
def test_a_rover_too_faint_to_see_is_placed_within_its_covariance(range_m, pairs):
    for seed in range(2):
        trial = run_trial(range_m, pairs, np.random.default_rng([seed, pairs]))
        assert trial.detected, trial.why
        assert trial.nees < 22  # 99.9 %
        assert np.trace(trial.covariance) < 2 * np.trace(trial.bound)


def test_jitter_drift_and_changing_light_do_no_harm():
    real = Nuisance(jitter_px=0.05, drift_px=0.2, light=0.02, texture=0.10)
    trial = run_trial(15.0, 110, np.random.default_rng(7), nuisance=real)
    assert trial.detected, trial.why
    assert trial.nees < 22


def test_dark_leds_are_refused_with_the_snr_that_was_missing():
    trial = run_trial(15.0, 110, np.random.default_rng(8), dark=True)
    assert not trial.detected
    assert "needed" in trial.why


@pytest.mark.slow
@pytest.mark.parametrize(("range_m", "pairs"), [(10.0, 50), (20.0, 300)])
def test_errors_are_at_the_bound_and_covariances_true(range_m, pairs):
    trials = [run_trial(range_m, pairs, np.random.default_rng([9, pairs, i])) for i in range(40)]
    accepted = [t for t in trials if t.detected]
    assert len(accepted) >= 39
    assert not any(t.false for t in accepted)
    errors = np.array([t.error for t in accepted])
    bounds = np.array([np.diag(t.bound) for t in accepted])
    ratio = np.sqrt((errors**2).sum(axis=0) / bounds.sum(axis=0))
    assert ratio[[0, 1, 5]].max() < 1.3 * 1.25  # the scatter of 40 trials
    assert 4.97 < np.mean([t.nees for t in accepted]) < 7.12  # 95 % band


@pytest.mark.slow
def test_noise_alone_shows_no_rover():
    trials = [run_trial(20.0, 40, np.random.default_rng([10, i]), dark=True) for i in range(60)]
    assert not any(t.detected for t in trials)
