"""Camera, cabin and chain against numerical derivatives, OpenCV and round trips."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.rig import (
    CabinCalibration,
    CameraCalibration,
    HeadCalibration,
    RigCalibration,
)
from perception.geometry.body import Transform, plc_in_body
from perception.geometry.camera import StereoModel, triangulate
from perception.geometry.chain import Chain, ChainState
from perception.geometry.rotation import (
    exp_map,
    log_map,
    matrix_from_quat,
    quat_from_matrix,
    rot_z,
)
from tests.perception.synthetic import scene

LENS = (-0.12, 0.05, 0.001, -0.002, 0.01)
BENT_RIG = RigCalibration(
    cameras=(
        CameraCalibration(distortion=LENS, position_ih_m=(0.02, 0.26, 0.01), yaw_ih_rad=-0.08),
        CameraCalibration(distortion=LENS, position_ih_m=(0.0, -0.25, 0.0), yaw_ih_rad=0.09, focal_px=2480.0),
    )
)
TURNED_RIG = RigCalibration(
    cameras=(
        CameraCalibration(
            position_ih_m=(0.0, 0.25, 0.0), yaw_ih_rad=-0.08, pitch_ih_rad=0.01, roll_ih_rad=0.02
        ),
        CameraCalibration(position_ih_m=(0.0, -0.25, 0.0), yaw_ih_rad=0.09, pitch_ih_rad=-0.02),
    ),
    head=HeadCalibration(pan_zero_rad=0.02, tilt_zero_rad=-0.01, lean_rad=(0.03, -0.02), axes_skew_rad=0.01),
)
angle = st.floats(-3.0, 3.0)
vector = st.tuples(angle, angle, angle).map(np.array)


def opencv_projection(camera, points_ih):
    axes = rot_z(camera.yaw_ih_rad) @ np.array([[0, 0, 1.0], [-1.0, 0, 0], [0, -1.0, 0]])
    t = -axes.T @ np.array(camera.position_ih_m)
    f, (cu, cv_) = camera.focal_px, camera.principal_px
    K = np.array([[f, 0, cu], [0, f, cv_], [0, 0, 1.0]])
    uv, _ = cv2.projectPoints(points_ih, cv2.Rodrigues(axes.T)[0], t, K, np.array(camera.distortion))
    return uv[:, 0]


def test_projection_agrees_with_opencv_for_both_cameras():
    points = np.array([[3.0, 0.1, -0.2], [5.0, -0.3, 0.4], [1.6, 0.05, 0.0]])
    uv = StereoModel.of(BENT_RIG).project(points)
    for camera in (0, 1):
        np.testing.assert_allclose(uv[camera], opencv_projection(BENT_RIG.cameras[camera], points), atol=1e-6)


def test_left_camera_sees_a_central_point_to_the_right():
    uv = StereoModel.of(RigCalibration()).project(np.array([[2.0, 0.0, 0.0]]))
    assert uv[0, 0, 0] > 511.5 > uv[1, 0, 0]
    assert uv[0, 0, 1] == pytest.approx(511.5)


def test_points_behind_the_camera_have_no_pixel():
    assert np.isnan(StereoModel.of(RigCalibration()).project(np.array([[-2.0, 0.0, 0.0]]))).all()


def test_triangulation_inverts_projection_through_distortion():
    model = StereoModel.of(BENT_RIG)
    points = np.array([[3.0, 0.1, -0.2], [9.0, -0.3, 0.4], [1.6, 0.05, 0.0]])
    np.testing.assert_allclose(triangulate(model, model.project(points)), points, atol=1e-9)


def test_triangulation_leaves_unseen_points_unknown():
    model = StereoModel.of(RigCalibration())
    uv = model.project(np.array([[3.0, 0.1, -0.2], [4.0, 0.0, 0.0]]))
    uv[1, 0] = np.nan
    points = triangulate(model, uv)
    assert np.isnan(points[0]).all()
    np.testing.assert_allclose(points[1], [4.0, 0.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("uv", [np.zeros((2, 0, 2)), np.zeros((3, 4, 2)), np.zeros((2, 2))])
def test_triangulation_refuses_wrong_shapes(uv):
    with pytest.raises(ValueError, match=r"uv_px: got shape .* expected \(2, n, 2\)"):
        triangulate(StereoModel.of(RigCalibration()), uv)


@pytest.mark.parametrize("rig", [RigCalibration(), BENT_RIG, TURNED_RIG])
def test_chain_jacobian_matches_central_differences(rig):
    chain, state = Chain.of(rig), scene(3.0, (0.1, -0.2, 2.0), (0.4, -0.3), rig=rig).state
    _, J = chain.project(state)
    for k, step in enumerate(np.eye(10) * 1e-6):
        rise = chain.project(state.moved(step))[0] - chain.project(state.moved(-step))[0]
        np.testing.assert_allclose(J[..., k], rise / 2e-6, atol=1e-4)


def test_raised_arm_lifts_the_plate_and_positive_cabin_leans_it_back():
    flat, raised = (plc_in_body(CabinCalibration(), arm, 0.0) for arm in (0.0, 0.5))
    assert raised.position_m[2] - flat.position_m[2] == pytest.approx(0.110 * np.sin(0.5))
    np.testing.assert_allclose(raised.rotation, np.eye(3))
    assert plc_in_body(CabinCalibration(), 0.0, 0.3).rotation[0, 2] == pytest.approx(-np.sin(0.3))


@given(vector)
@settings(max_examples=60, deadline=None)
def test_rotation_forms_agree(turn):
    R = exp_map(turn)
    np.testing.assert_allclose(exp_map(log_map(R)), R, atol=1e-9)
    np.testing.assert_allclose(matrix_from_quat(quat_from_matrix(R)), R, atol=1e-12)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)


def test_stereo_coverage_is_that_of_the_paper():
    """Paper, table 4: 0.44, 2.78 and 5.06 m of width seen by both cameras."""
    model = StereoModel.of(RigCalibration())
    for distance, width in ((1.6, 0.44), (10.0, 2.78), (20.0, 5.06)):
        y = np.linspace(-4, 4, 8001)
        points = np.stack([np.full_like(y, distance), y, np.zeros_like(y)], axis=1)
        both = model.inside(model.project(points)).all(axis=0)
        assert np.ptp(y[both]) == pytest.approx(width, rel=0.03)  # the paper mixes 23 deg and 35 mm


def test_a_moved_state_turns_the_body_from_the_left():
    state = ChainState(Transform(exp_map(np.array([0.3, 0.0, 1.0])), np.zeros(3)), (0.0, 0.0), (0.0, 0.0))
    moved = state.moved(np.array([0, 0, 0, 0, 0, 0.1, 0, 0, 0, 0]))
    np.testing.assert_allclose(moved.site_body.rotation, rot_z(0.1) @ state.site_body.rotation, atol=1e-12)
