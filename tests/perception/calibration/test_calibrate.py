"""Calibration in situ: planted errors come out, with a covariance that is true, whatever is mismatched."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from perception.calibration import NAMES, Survey, calibrate, changed_rig
from perception.calibration.parameters import prior_sigmas
from perception.geometry.chain import Chain
from perception.geometry.pose import Sighting, estimate
from tests.perception.calibration.field import BELIEVED, DEGREE, Field, rover_at, survey

SMALL = Field(
    stations=((1.8, -0.3), (2.5, 0.2), (4.0, 0.0)),
    rocks=14,
    pans_deg=(-13.0, -6.0, 0.0, 6.0, 13.0),
)
PLANTED = {"vergence": 0.3 * DEGREE, "pan_zero": 1.0 * DEGREE, "focal": 5e-3}
WEIGHTS = np.broadcast_to(0.01 * np.eye(2), (2, 4, 2, 2))


def planted():
    return np.array([PLANTED.get(name, 0.0) for name in NAMES])


@cache
def views(outliers=0.0, seed=1):
    return survey(planted(), np.random.default_rng([33, seed]), SMALL, outliers)


@cache
def found(outliers=0.0):
    return calibrate(BELIEVED, views(outliers))


def systematic_error(true, used):
    state = rover_at(Chain.of(true), 10.0)
    uv, _ = Chain.of(true).project(state)
    seen = Sighting(uv, WEIGHTS, state.head_rad, state.joints_rad)
    return (
        estimate(Chain.of(used), seen, state.site_body).state.site_body.position_m
        - state.site_body.position_m
    )


def off_in_sigmas(calibrated, values):
    return (calibrated.values - values) / np.sqrt(np.diag(calibrated.covariance))


@pytest.mark.parametrize("outliers", [0.0, 0.05])
def test_planted_errors_of_vergence_pan_and_focal_length_come_out(outliers):
    calibrated = found(outliers)
    assert calibrated.consistent()
    assert np.abs(off_in_sigmas(calibrated, planted())).max() < 4
    for name, value in PLANTED.items():
        assert calibrated.sigma(name) < value / 10
        assert calibrated.value(name) == pytest.approx(value, rel=0.15)


def test_a_rover_at_10_m_is_found_ten_times_better_and_inside_the_covariance():
    true, calibrated = changed_rig(BELIEVED, planted()), found()
    before, after = systematic_error(true, BELIEVED), systematic_error(true, calibrated.rig)
    assert np.linalg.norm(before) > 1.0  # m
    assert np.linalg.norm(after) < np.linalg.norm(before) / 10
    claimed = calibrated.systematic_covariance(rover_at(Chain.of(true), 10.0), WEIGHTS)[:3, :3]
    assert after @ np.linalg.solve(claimed, after) < chi2.ppf(0.999, 3)


def test_five_percent_of_mismatches_are_set_aside_and_little_else():
    calibrated = found(0.05)
    assert 0.03 < calibrated.rejected / calibrated.images < 0.08
    assert found().rejected <= 1


def test_the_covariance_is_true_over_rigs_drawn_from_the_prior():
    rng, trials = np.random.default_rng(8), 3
    nees = []
    for _ in range(trials):
        values = prior_sigmas() * rng.standard_normal(len(NAMES))
        calibrated = calibrate(BELIEVED, survey(values, rng, SMALL))
        error = calibrated.values - values
        nees.append(error @ np.linalg.solve(calibrated.covariance, error))
    low, high = chi2.ppf((0.001, 0.999), len(NAMES) * trials) / trials
    assert low < np.mean(nees) < high


def test_without_landmarks_the_pan_zero_keeps_its_prior_and_is_named():
    calibrated = calibrate(BELIEVED, replace(views(), landmarks={}))
    assert "pan_zero" not in calibrated.observed()
    assert calibrated.sigma("pan_zero") > 0.9 * DEGREE
    assert abs(calibrated.value("pan_zero")) < 0.1 * DEGREE  # the planted degree cannot be seen
    assert any(direction.parts[0][0] == "pan_zero" for direction in calibrated.unobserved())
    assert "vergence" in calibrated.observed()


def test_at_one_temperature_its_drift_is_not_observed_and_at_several_it_is():
    drifting = {"focal_per_k", "vergence_per_k"}
    assert drifting.isdisjoint(found().observed())
    values = planted()
    values[NAMES.index("vergence_per_k")] = 1e-5
    warmed = survey(values, np.random.default_rng(6), replace(SMALL, warmer_k=(-30.0, 0.0, 30.0)))
    calibrated = calibrate(BELIEVED, warmed)
    assert drifting <= set(calibrated.observed())
    assert calibrated.value("vergence_per_k") == pytest.approx(
        1e-5, abs=4 * calibrated.sigma("vergence_per_k")
    )
    change = calibrated.rig_at(303.0).cameras[1].yaw_ih_rad - calibrated.rig.cameras[1].yaw_ih_rad
    assert change == pytest.approx(10 * calibrated.value("vergence_per_k"))


def test_a_narrow_prior_holds_a_parameter_where_it_is():
    calibrated = calibrate(BELIEVED, views(), {"vergence": 1e-9})
    assert abs(calibrated.value("vergence")) < 1e-7
    assert not calibrated.consistent()  # and what it should have explained is left over


def test_the_summary_names_every_parameter_and_what_was_not_seen():
    text = str(found())
    assert all(name in text for name in NAMES)
    assert "not observed: +1.00 vergence_per_k" in text


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda s: Survey(()), "looks: got none"),
        (lambda s: replace(s, looks=(replace(s.looks[0], rover=None),)), "none that shows rover or points"),
        (lambda s: replace(s, stations=()), "got station 0 of 0"),
        (lambda s: replace(s, looks=s.looks[:5]), "station 1: got no look with 3 markers"),
        (
            lambda s: replace(s, looks=(replace(s.looks[0], temperature_k=float("nan")),)),
            r"looks\[0\].temperature_k: got nan",
        ),
        (
            lambda s: replace(
                s, looks=(replace(s.looks[0], rover=replace(s.looks[0].rover, sigma_px=np.zeros((2, 4)))),)
            ),
            r"looks\[0\].rover.sigma_px: expected positive",
        ),
        (
            lambda s: replace(
                s, looks=(replace(s.looks[0], rover=replace(s.looks[0].rover, uv_px=np.zeros((2, 3, 2)))),)
            ),
            r"looks\[0\].rover.uv_px: got shape \(2, 3, 2\), expected \(2, 4, 2\)",
        ),
        (
            lambda s: replace(
                s, landmarks={n: replace(m, covariance=-m.covariance) for n, m in s.landmarks.items()}
            ),
            "positive definite",
        ),
    ],
)
def test_a_survey_that_makes_no_sense_is_refused_in_words(change, complaint):
    with pytest.raises(ValueError, match=complaint):
        calibrate(BELIEVED, change(views()))


@pytest.mark.parametrize(
    ("priors", "complaint"), [({"vergance": 1.0}, "vergance"), ({"focal": 0.0}, "focal: got 0")]
)
def test_priors_are_of_parameters_and_positive(priors, complaint):
    with pytest.raises(ValueError, match=complaint):
        calibrate(BELIEVED, views(), priors)
