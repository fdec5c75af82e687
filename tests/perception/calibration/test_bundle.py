"""The bundle's Jacobian against central differences, and the parts that it is made of."""

import numpy as np
import pytest

from executive.core.types import Centres, HeadReading, Shot
from perception.calibration import NAMES, Look, calibrate, changed_rig
from perception.calibration.bundle import Bundle
from perception.calibration.parameters import prior_sigmas
from perception.calibration.start import first_guess
from perception.calibration.target_images import TargetImages
from perception.calibration.unknowns import Bearing, turn_rate
from perception.geometry.chain import Chain
from perception.geometry.rotation import exp_map
from tests.perception.calibration.field import BELIEVED, Field, survey
from tests.perception.geometry.test_geometry import BENT_RIG

TINY = Field(
    stations=((2.0, -0.2), (3.0, 0.2)),
    aside_deg=((0, 0), (4, -3)),
    rocks=8,
    landmarks=2,
    pans_deg=(-6.0, 0.0, 6.0),
    tilts_deg=(8.0,),
    warmer_k=(-10.0, 0.0, 10.0),
)


def bundle(seed=3):
    seen = survey(prior_sigmas(), np.random.default_rng(seed), TINY)
    sightings = TargetImages.of(seen, 4)
    unknowns = first_guess(BELIEVED, seen, sightings, len(NAMES))
    return Bundle(BELIEVED, seen, sightings, unknowns, prior_sigmas(), 293.0)


def test_jacobian_matches_central_differences_far_from_the_start_too():
    problem, rng, step = bundle(), np.random.default_rng(4), 1e-6
    x = problem.unknowns.start()
    x = x + 0.02 * rng.standard_normal(len(x)) * np.where(x == 0, 1.0, 0.1)
    J = problem.dense_jacobian(x)
    for i, move in enumerate(np.eye(len(x)) * step):
        rise = (problem.residuals(x + move) - problem.residuals(x - move)) / (2 * step)
        np.testing.assert_allclose(J[:, i], rise, atol=2e-5 * (1 + np.abs(rise).max()))


def test_residuals_of_the_truth_are_noise_alone():
    """As many degrees of freedom as are claimed, to within the scatter of a few surveys."""
    fits = [calibrate(BELIEVED, survey(0 * prior_sigmas(), np.random.default_rng(s), TINY)) for s in range(4)]
    chi2, dof = sum(f.chi2 for f in fits), sum(f.dof for f in fits)
    unmoved = len(NAMES) * len(fits)  # parameters that the views do not move leave less than one each
    assert dof - unmoved - 4 * np.sqrt(2 * dof) < chi2 < dof + 4 * np.sqrt(2 * dof)


def test_a_point_that_one_image_shows_is_left_out_unless_it_is_a_landmark():
    seen = survey(prior_sigmas(), np.random.default_rng(3), TINY)
    images = TargetImages.of(seen, 4).images_of_targets()[8:]
    names = TargetImages.of(seen, 4).names
    free = [count for name, count in zip(names, images, strict=True) if name not in seen.landmarks]
    assert 1 not in free


def test_rotation_vectors_turn_at_the_rate_that_is_said():
    turn = np.array([0.3, -0.4, 0.2])
    for i, step in enumerate(np.eye(3) * 1e-6):
        rise = (exp_map(turn + step) - exp_map(turn - step)) @ exp_map(turn).T / 2e-6
        np.testing.assert_allclose([rise[2, 1], rise[0, 2], rise[1, 0]], turn_rate(turn)[:, i], atol=1e-8)


def test_a_bearing_starts_at_its_point():
    point, mast = np.array([3.0, -1.0, 0.2]), np.array([0.0, 0.0, 1.5])
    bearing = Bearing.towards(mast, point)
    np.testing.assert_allclose(bearing.place(np.array([0.0, 0.0, bearing.rho]))[0], point, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_every_parameter_moves_what_the_head_sees(name):
    """Zero changes nothing, anything else does; drifts only when it is warmer."""
    values = np.array([0.01 if name == other else 0.0 for other in NAMES])
    points = np.array([[4.0, 0.3, 0.2], [6.0, -0.3, 0.1]])
    assert changed_rig(BENT_RIG, 0 * values) == BENT_RIG
    warmer = 1.0 if name.endswith("_per_k") else 0.0
    changed = changed_rig(BENT_RIG, values, warmer)
    if name == "marker_scale":
        assert changed.markers.positions_plc_m[0][0] == pytest.approx(1.01 * 0.060)
        return

    def uv(rig):
        chain = Chain.of(rig)
        return chain.model.project(chain.site_ih((0.1, 0.2)).inverse().apply(points))

    assert np.abs(uv(changed) - uv(BENT_RIG)).max() > 0.1


def test_a_look_takes_marker_centres_as_the_cameras_give_them():
    uv, sigma = np.full((2, 4, 2), 500.0), np.full((2, 4), 0.1)
    centres = Centres(5.0, Shot(leds=(0, 1)), uv, sigma, HeadReading(5.0, 0.1, 0.2, False))
    look = Look.at_rover(centres, station=3)
    assert look.head_rad == (0.1, 0.2)
    assert look.rover is not None
    assert look.rover.station == 3
    assert look.rover.uv_px is uv
