"""Pose from rendered pictures of the marker box, against where the robot was put."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from yard_robot.detection import find_markers
from yard_robot.marker_box import FACES, corners_body_m
from yard_robot.marker_pose import MarkerPose, solve
from yard_robot.model import HuskyModel
from yard_robot.pole_camera import draw, project, window_around
from yard_robot.rig import YardRig

RIG = YardRig()


@pytest.fixture(scope="module")
def model() -> Iterator[HuskyModel]:
    made = HuskyModel(RIG.rover, RIG.box)
    yield made
    made.close()


def look(model, x_m, y_m, heading, covered=(), seed=0):
    """The pose found of a robot put there, and its true place and rotation."""
    rotation = Rotation.from_euler("z", heading)
    model.covered = frozenset(covered)
    model.put((x_m, y_m, 0.0), tuple(rotation.as_quat()))
    corners = np.concatenate([corners_body_m(RIG.box, face) for face in FACES])
    corners_px = project(RIG.camera, at((x_m, y_m, 0.0), rotation, corners))
    window = window_around(RIG.camera, corners_px, 30.0)
    image = draw(model.client, RIG.camera, window, 1.0, np.random.default_rng(seed))
    return solve(RIG.camera, RIG.box, find_markers(image, window)), np.array([x_m, y_m, 0.0]), rotation


def at(place, rotation, points):
    """Points of the body in `site`."""
    return rotation.apply(points) + np.array(place)


def error(found: MarkerPose, place, rotation) -> np.ndarray:
    turned = rotation * Rotation.from_matrix(found.rotation).inv()
    return np.concatenate([place - found.position_m, turned.as_rotvec()])


@pytest.mark.parametrize(("x_m", "y_m"), [(3.5, 0.0), (6.0, 2.5), (9.0, -3.0)])
def test_pose_is_found_all_over_the_yard(model, x_m, y_m):
    found, place, rotation = look(model, x_m, y_m, 0.7)
    off = error(found, place, rotation)
    assert np.hypot(*off[:2]) < 0.04
    assert abs(off[5]) < math.radians(0.6)


def test_errors_are_as_large_as_the_covariance_says(model):
    rng = np.random.default_rng(3)
    squares = []
    for number in range(60):
        x_m, slope, heading = rng.uniform((3.5, -0.4, -3.0), (9.5, 0.4, 3.0))
        found, place, rotation = look(model, x_m, slope * x_m, heading, seed=number)
        off = error(found, place, rotation)
        squares.append(off @ np.linalg.solve(found.covariance, off))
    assert 3.0 < np.mean(squares) < 8.0  # 6 if it were exact


def test_one_face_alone_gives_a_wider_covariance(model):
    every, *_ = look(model, 7.0, 0.0, 0.7)
    one, place, rotation = look(model, 7.0, 0.0, 0.7, covered=("top", "left", "front", "right"))
    assert one.faces == ("back",)
    assert np.trace(one.covariance[:2, :2]) > 2 * np.trace(every.covariance[:2, :2])
    assert np.hypot(*error(one, place, rotation)[:2]) < 0.15


def test_covered_box_is_said_to_be_unseen(model):
    found, *_ = look(model, 7.0, 0.0, 0.7, covered=FACES)
    assert found == "no marker is seen"


def test_marker_with_a_wrong_corner_is_left_out(model):
    rotation = Rotation.from_euler("z", 0.7)
    seen = {
        face: project(RIG.camera, at((7.0, 0.0, 0.0), rotation, corners_body_m(RIG.box, face)))
        for face in ("top", "back", "left")
    }
    seen["back"][2] += (0.0, 12.0)
    found = solve(RIG.camera, RIG.box, seen)
    assert set(found.faces) == {"top", "left"}
    assert found.position_m == pytest.approx([7.0, 0.0, 0.0], abs=1e-6)


def test_marker_that_fits_no_upright_robot_is_refused(model):
    lying = Rotation.from_euler("x", 90, degrees=True)
    seen = {"top": project(RIG.camera, at((7.0, 0.0, 0.5), lying, corners_body_m(RIG.box, "top")))}
    assert solve(RIG.camera, RIG.box, seen) == "the top marker alone fits no upright robot"
