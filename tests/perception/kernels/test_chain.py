"""The compiled chain against the same written out with scipy's rotations and numpy's solvers."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from executive.core.rig import RigCalibration
from perception.geometry.chain import Chain
from perception.geometry.pose import (
    PoseReadings,
    Prior,
    Sighting,
    estimate,
    linear_guess,
    roll_pitch,
)
from perception.geometry.rotation import (
    exp_map,
    log_map,
    nearest_rotation,
    quat_from_matrix,
)
from perception.kernels.compiled import plain
from perception.kernels.gauss_newton import PoseProblem, normal_equations, weights_of
from perception.kernels.linear import inverted
from tests.perception.geometry.test_geometry import BENT_RIG, TURNED_RIG
from tests.perception.synthetic import scene

RIGS = [RigCalibration(), BENT_RIG, TURNED_RIG]


def by_hand(chain, x):
    """Marker pixels (2, n, 2) of x: position, rotation vector, pan, tilt, arm, cabin; and the attitude."""
    rig, R = chain.rig, Rotation.from_rotvec(x[3:6])
    pan, tilt, arm, cabin = x[6:]
    raised = np.array([np.cos(arm), 0, np.sin(arm)]) * rig.cabin.arm_length_m
    turned = Rotation.from_euler("y", -cabin).apply(chain.markers_plc_m + rig.cabin.plc_offset_cabin_m)
    site = R.apply(turned + raised + rig.cabin.arm_pivot_body_m) + x[:3]
    head, (roll, pitch) = rig.head, rig.head.lean_rad
    axes = [pitch, roll, pan + head.pan_zero_rad, head.axes_skew_rad, tilt + head.tilt_zero_rad]
    turn = np.prod([Rotation.from_euler(a, angle) for a, angle in zip("yxzxy", axes, strict=True)])
    in_head = turn.inv().apply(site - [0, 0, head.mast_height_m])
    uv = []
    for camera in rig.cameras:
        angles = camera.yaw_ih_rad, camera.pitch_ih_rad, camera.roll_ih_rad
        looks = Rotation.from_euler("ZYX", angles).inv().apply(in_head - camera.position_ih_m)
        a, b = -looks[:, 1] / looks[:, 0], -looks[:, 2] / looks[:, 0]
        k1, k2, p1, p2, k3 = camera.distortion
        r2 = a**2 + b**2
        radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
        bent_a = a * radial + 2 * p1 * a * b + p2 * (r2 + 2 * a**2)
        bent_b = b * radial + p1 * (r2 + 2 * b**2) + 2 * p2 * a * b
        uv.append(camera.focal_px * np.stack([bent_a, bent_b], axis=1) + camera.principal_px)
    return np.array(uv), R


def vector_of(state):
    body = state.site_body
    turn = Rotation.from_matrix(body.rotation).as_rotvec()
    return np.concatenate([body.position_m, turn, state.head_rad, state.joints_rad])


def seen_by(rig, rng, hidden=True):
    """A scene at 4 m, a sighting with uneven noise and a marker hidden, a prediction."""
    true = scene(4.0, (0.1, -0.2, 2.0), (0.4, -0.3), rig=rig)
    spread = 0.05 * rng.standard_normal((2, 4, 2, 2))
    covariance = 0.01 * np.eye(2) + spread @ np.swapaxes(spread, -1, -2)
    uv = true.uv_px + 0.1 * rng.standard_normal((2, 4, 2))
    if hidden:
        uv[1, 2] = np.nan
    tilt = roll_pitch(true.state.site_body.rotation)[0] + 0.002 * rng.standard_normal(2)
    seen = Sighting(uv, covariance, true.state.head_rad, true.state.joints_rad, (tilt[0], tilt[1]))
    return true, seen, Prior(true.state.site_body, np.diag([0.01] * 3 + [0.02] * 3) ** 2)


def residuals(chain, seen, prior, x):
    """All that was measured less what x gives, in sigmas."""
    uv, R = by_hand(chain, x)
    whitened = []
    for off, P in zip((seen.uv_px - uv).reshape(-1, 2), seen.covariance_px2.reshape(-1, 2, 2), strict=True):
        if np.isfinite(off).all():
            whitened.append(np.linalg.solve(np.linalg.cholesky(P), off))
    encoders = (np.array([*seen.head_rad, *seen.joints_rad]) - x[6:]) / chain.encoder_sigma_rad()
    _, pitch, roll = R.as_euler("ZYX")
    tilt = (np.array(seen.tilt_rad) - [roll, pitch]) / chain.rig.rover.inclinometer_sigma_rad
    turn = (Rotation.from_matrix(prior.site_body.rotation) * R.inv()).as_rotvec()
    off = np.concatenate([prior.site_body.position_m - x[:3], turn])
    return np.concatenate([*whitened, encoders, tilt, off / np.sqrt(np.diag(prior.covariance))])


@pytest.mark.parametrize("rig", RIGS, ids=["plain", "bent", "turned"])
def test_pixels_are_those_of_a_pinhole_written_out(rig):
    true = scene(4.0, (0.1, -0.2, 2.0), (0.4, -0.3), rig=rig)
    expected, _ = by_hand(true.chain, vector_of(true.state))
    np.testing.assert_allclose(true.chain.project(true.state)[0], expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("rig", RIGS, ids=["plain", "bent", "turned"])
def test_normal_equations_are_those_of_the_residuals_written_out(rig):
    true, seen, prior = seen_by(rig, np.random.default_rng(7))
    chain, state = true.chain, true.state
    readings = PoseReadings.of(chain, seen, prior)
    weights, count = weights_of(plain(seen.uv_px), plain(seen.covariance_px2))
    problem = PoseProblem(*chain.kernel_rig, readings.measured, plain(seen.uv_px), weights)
    body = state.site_body
    H, g, chi2 = normal_equations(problem, plain(body.rotation), plain(body.position_m), state.angles_rad)
    off = residuals(chain, seen, prior, vector_of(state))
    slopes = [
        residuals(chain, seen, prior, vector_of(state.moved(s)))
        - residuals(chain, seen, prior, vector_of(state.moved(-s)))
        for s in np.eye(10) * 1e-6
    ]
    J = np.array(slopes) / 2e-6
    assert count == 7
    assert chi2 == pytest.approx(off @ off, rel=1e-9)
    np.testing.assert_allclose(np.tril(H), np.tril(J @ J.T), rtol=1e-5, atol=1e-6 * np.abs(H).max())
    np.testing.assert_allclose(g, -J @ off, rtol=1e-4, atol=1e-6 * np.abs(g).max())


@pytest.mark.parametrize("rig", RIGS, ids=["plain", "bent", "turned"])
def test_the_pose_is_that_of_scipys_least_squares(rig):
    true, seen, prior = seen_by(rig, np.random.default_rng(8))
    fix = estimate(true.chain, seen, true.state.site_body, prior)
    found = least_squares(
        lambda x: residuals(true.chain, seen, prior, x), vector_of(true.state), x_scale="jac", xtol=1e-15
    )
    assert fix.converged
    assert fix.chi2 == pytest.approx(2 * found.cost, rel=1e-9)
    np.testing.assert_allclose(vector_of(fix.state), found.x, rtol=0, atol=1e-7)
    np.testing.assert_allclose(
        fix.residual_px[0], (seen.uv_px - by_hand(true.chain, found.x)[0])[0], atol=1e-4
    )
    assert np.isnan(fix.residual_px[1, 2]).all()


def test_the_first_guess_has_the_rotation_nearest_to_the_affine_map():
    rng, plate = np.random.default_rng(9), np.array(RigCalibration().markers.positions_plc_m)
    for _ in range(20):
        points = plate @ exp_map(rng.standard_normal(3)).T + 0.02 * rng.standard_normal(plate.shape) + 3
        ones = np.ones((4, 1))
        A = np.linalg.lstsq(np.hstack([plate[:, :2], ones]), points, rcond=None)[0].T
        nearest = nearest_rotation(np.column_stack([A[:, 0], A[:, 1], np.cross(A[:, 0], A[:, 1])]))
        guess = linear_guess(points, plate)
        np.testing.assert_allclose(guess.rotation, nearest, atol=1e-12)
        np.testing.assert_allclose(guess.apply(plate).mean(axis=0), points.mean(axis=0), atol=1e-12)


def test_rotations_are_those_of_scipy():
    rng = np.random.default_rng(10)
    turns = [
        *(rng.standard_normal((30, 3)) * 10.0 ** rng.integers(-9, 1, (30, 1))),
        [3.14159, 0, 0],
        [0, 0, 0.0],
    ]
    for turn in map(np.array, turns):
        R = Rotation.from_rotvec(turn)
        np.testing.assert_allclose(exp_map(turn), R.as_matrix(), rtol=0, atol=1e-15)
        np.testing.assert_allclose(log_map(R.as_matrix()), R.as_rotvec(), rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(quat_from_matrix(R.as_matrix()), R.as_quat(canonical=True), atol=1e-15)


def test_what_is_not_positive_definite_has_no_inverse():
    spread = np.random.default_rng(11).standard_normal((10, 14))
    np.testing.assert_allclose(
        inverted(spread @ spread.T, 6), np.linalg.inv(spread @ spread.T)[:6, :6], rtol=1e-9
    )
    assert np.isnan(inverted(np.diag([1.0, -1.0, 1.0]), 3)).any()


def test_a_rig_makes_its_constants_once():
    chain = Chain.of(RigCalibration())
    assert chain.kernel_rig is chain.kernel_rig
