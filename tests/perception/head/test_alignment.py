"""What the ground says of the head: planted rotations and shifts are told, disagreement is not believed."""

from dataclasses import replace

import numpy as np
import pytest

from executive.core.rig import RigCalibration
from executive.core.types import (
    Centres,
    HeadReading,
    Landmarks,
    Shot,
)
from perception.geometry.chain import Chain
from perception.geometry.rotation import exp_map
from perception.head.alignment import Alignment, align

CHAIN = Chain.of(RigCalibration())
HEAD_RAD = (0.4, 0.61)
MAST_M = np.array([0.0, 0.0, CHAIN.rig.head.mast_height_m])


def picture(rng, turned=(0, 0, 0), shifted=(0, 0, 0), apart_rad=0.0, sigma_px=0.03, wrong_share=0.0):
    """Landmarks on level ground as a head sees them whose frame is turned and shifted in truth."""
    axis = np.arange(-4, 4, 0.15)
    x, y = (grid.ravel() for grid in np.meshgrid(axis, axis))
    ground = np.stack([x, y, np.zeros_like(x)], axis=1)
    seen = MAST_M + (ground - MAST_M - np.array(shifted)) @ exp_map(np.array(turned, dtype=float))
    uv = CHAIN.model.project(CHAIN.site_ih(HEAD_RAD).inverse().apply(seen))
    uv[1, :, 0] += 0.5 * 2500 * apart_rad
    uv[0, :, 0] -= 0.5 * 2500 * apart_rad
    inside = CHAIN.model.inside(uv)
    sides = []
    for camera in (0, 1):
        names = np.flatnonzero(inside[camera])
        at = uv[camera, names] + sigma_px * rng.standard_normal((len(names), 2))
        wrong = rng.uniform(size=len(names)) < wrong_share
        at[wrong] += rng.uniform(-200, 200, (wrong.sum(), 2))
        sides.append(Landmarks(names, at))
    nothing = np.full((2, 4, 2), np.nan)
    head = HeadReading(0.0, *HEAD_RAD, False)
    return Centres(0.0, Shot((0,)), nothing, nothing[..., 0], head, (sides[0], sides[1]))


@pytest.mark.parametrize("turned_deg", [(0, 0, 0), (0, 0, 2), (0.3, 0, 0), (0.1, -0.2, 0.4), (0, 0, -4)])
def test_a_planted_rotation_is_told_in_all_axes(turned_deg):
    rng = np.random.default_rng(1)
    found = align(CHAIN, picture(rng), picture(rng, np.radians(turned_deg)))
    assert np.abs(np.degrees(found.mean[:3]) - turned_deg).max() < 0.01
    assert np.abs(found.mean[3:6]).max() < 0.002


def test_a_shift_is_told_from_a_rotation():
    rng = np.random.default_rng(2)
    found = align(CHAIN, picture(rng), picture(rng, shifted=(0.005, 0.0, -0.02)))
    np.testing.assert_allclose(found.mean[3:6], (0.005, 0.0, -0.02), atol=0.001)
    assert np.abs(np.degrees(found.mean[:3])).max() < 0.02


def test_cameras_that_part_are_told_from_a_head_that_turns():
    rng = np.random.default_rng(3)
    found = align(CHAIN, picture(rng), picture(rng, apart_rad=0.001))
    assert found.mean[6] == pytest.approx(0.001, abs=2e-5)
    assert np.abs(np.degrees(found.mean[:3])).max() < 0.02


def test_a_quarter_of_wrong_matches_does_no_harm():
    rng = np.random.default_rng(4)
    found = align(CHAIN, picture(rng), picture(rng, (0, 0, 0.01), wrong_share=0.25))
    assert found.mean[2] == pytest.approx(0.01, abs=2e-4)


def test_what_does_not_move_as_one_is_not_known():
    rng = np.random.default_rng(5)
    found = align(CHAIN, picture(rng), picture(rng, wrong_share=0.8))
    assert isinstance(found, str)


def test_too_little_ground_is_not_known():
    rng = np.random.default_rng(6)
    left, right = picture(rng).ground
    few = replace(picture(rng), ground=(left, Landmarks(right.names[:3], right.uv_px[:3])))
    assert "3 patches" in align(CHAIN, picture(rng), few)


def test_the_reported_covariance_holds_the_scatter():
    rng = np.random.default_rng(7)
    pan_sigma, tilt_sigma = CHAIN.encoder_sigma_rad()[:2]
    tilt_axis = np.array([-np.sin(HEAD_RAD[0]), np.cos(HEAD_RAD[0]), 0.0])

    def missed():
        return rng.normal(0, pan_sigma) * np.array([0, 0, 1.0]) + rng.normal(0, tilt_sigma) * tilt_axis

    squares = []
    for _ in range(40):
        found = align(CHAIN, picture(rng, missed()), picture(rng, missed()))
        squares.append(found.mean @ np.linalg.solve(found.covariance, found.mean))
    assert 1.0 < np.mean(squares) < 12.0  # 8 degrees of freedom, of which the floors hold some still


def test_a_turn_of_the_head_moves_a_fix_by_its_arm():
    turned = Alignment(np.array([0, 0, 0.01, 0, 0, 0, 0, 0]), 1e-8 * np.eye(8))
    off_m, covariance = turned.error_at(CHAIN, np.array([5.0, 0.0, 0.0]))
    np.testing.assert_allclose(off_m, (0.0, 0.05, 0.0), atol=1e-9)
    assert covariance.shape == (3, 3)


def test_two_looks_say_more_than_one():
    one = Alignment(np.full(8, 0.01), 1e-4 * np.eye(8))
    two = one.fuse(Alignment(np.full(8, 0.03), 1e-4 * np.eye(8)))
    np.testing.assert_allclose(two.mean, 0.02)
    np.testing.assert_allclose(two.covariance, 0.5e-4 * np.eye(8), atol=1e-12)
