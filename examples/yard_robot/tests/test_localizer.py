"""The localizer: where it looks, and why it finds nothing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from executive.isc.attitude import quat_from_heading_tilt
from longarm import LocaliseRequest, PoseEstimate, PoseSource, Quality, Reason

from yard_robot.localizer import MarkerLocalizer
from yard_robot.marker_box import FACES


def expected(x_m=5.0, y_m=0.0, heading=0.0, sigma_m=0.05) -> PoseEstimate:
    covariance = np.diag([sigma_m**2] * 3 + [0.01] * 3)
    quat = quat_from_heading_tilt(heading, 0.0, 0.0)
    return PoseEstimate(0.0, (x_m, y_m, 0.0), quat, covariance, PoseSource.PREDICTION)


def locate(world, pose):
    action = MarkerLocalizer(world.eye, world.rig).locate(LocaliseRequest(Quality.PRECISE, pose))
    for _ in range(20):
        world.advance()
        world.eye.settle()
        if (outcome := action.poll()) is not None:
            return outcome
    raise AssertionError("no outcome within 20 ticks")


def test_robot_is_found_where_it_is_expected(world):
    fix = locate(world, expected()).value.pose
    assert (fix.x_m, fix.y_m) == pytest.approx((5.0, 0.0), abs=0.03)
    assert fix.heading_rad == pytest.approx(0.0, abs=math.radians(1.0))
    assert world.eye.taken == 1


def test_robot_elsewhere_is_found_by_a_second_look(world):
    fix = locate(world, expected(x_m=8.0, y_m=2.0)).value.pose
    assert (fix.x_m, fix.y_m) == pytest.approx((5.0, 0.0), abs=0.05)
    assert world.eye.taken == 2


def test_dark_picture_is_no_missing_robot(world):
    world.iris = 0.02
    outcome = locate(world, expected())
    assert outcome.reason is Reason.UNSTABLE_IMAGES
    assert "too dark" in outcome.detail


def test_covered_markers_are_not_seen(world):
    world.model.covered = frozenset(FACES)
    outcome = locate(world, expected())
    assert outcome.reason is Reason.NOT_SEEN
    assert outcome.detail == "no marker is seen"


def test_window_grows_with_the_uncertainty(world):
    localizer = MarkerLocalizer(world.eye, world.rig)
    near = localizer.windows(expected(sigma_m=0.02))[0]
    far = localizer.windows(expected(sigma_m=0.30))[0]
    assert far.width > near.width + 50


def test_robot_behind_the_camera_is_looked_for_everywhere(world):
    localizer = MarkerLocalizer(world.eye, world.rig)
    (window,) = localizer.windows(replace(expected(), position_site_m=(-8.0, 0.0, 0.0)))
    assert (window.width, window.height) == (world.rig.camera.width_px, world.rig.camera.height_px)


def test_cancelled_localisation_takes_no_picture(world):
    action = MarkerLocalizer(world.eye, world.rig).locate(LocaliseRequest(Quality.PRECISE, expected()))
    action.cancel()
    for _ in range(5):
        world.advance()
        world.eye.settle()
    assert action.poll().reason is Reason.CANCELLED
    assert world.eye.taken == 0
