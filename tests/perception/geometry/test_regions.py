"""Windows, exposures, and where the head looks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.rig import RigCalibration
from perception.frames.exposure import (
    PlateView,
    filter_snr_per_pair,
    pairs_needed,
    plate_view,
)
from perception.frames.psf import marker_spread
from perception.geometry.body import Transform
from perception.geometry.chain import Chain, ChainState
from perception.geometry.follow_up import in_overlap, off_middle_rad, pointing_at
from perception.geometry.roi import predicted_windows
from perception.geometry.rotation import exp_map
from tests.perception.synthetic import scene

CHAIN = Chain.of(RigCalibration())


@pytest.mark.parametrize("heading_sigma", [0.03, 0.2, 3.0])
def test_windows_hold_the_markers_999_times_in_1000(heading_sigma):
    rng, true = np.random.default_rng(1), scene(3.0)
    P = np.diag([0.03, 0.03, 0.01, 0.02, 0.02, heading_sigma]) ** 2
    windows = predicted_windows(CHAIN, true.state, P, 0.0)
    L, held, count = np.linalg.cholesky(true.chain.state_covariance(P)), 0, 3000
    for _ in range(count):
        uv, _ = CHAIN.project(true.state.moved(L @ rng.standard_normal(10)))
        held += all(
            (uv[c] >= (w.u, w.v)).all() and (uv[c] <= (w.u + w.width - 1, w.v + w.height - 1)).all()
            for c, w in enumerate(windows)
        )
    assert held / count >= 0.999


def test_windows_widen_with_uncertainty_and_stay_in_the_frame():
    state = scene(3.0).state
    sides = [
        predicted_windows(CHAIN, state, np.eye(6) * sigma**2, 8.0, widen)[0].width
        for sigma, widen in ((0.005, 1.0), (0.02, 1.0), (0.02, 2.0), (10.0, 1.0))
    ]
    assert sides == sorted(set(sides))
    assert sides[-1] == 1024


def test_there_is_no_window_for_markers_out_of_sight():
    behind = ChainState(Transform(np.eye(3), np.array([-3.0, 0.0, 0.0])), (0.0, 0.4), (0.0, 0.0))
    beside = ChainState(Transform(np.eye(3), np.array([2.0, 2.0, 0.0])), (0.0, 0.5), (0.0, 0.0))
    for state in (behind, beside):
        assert predicted_windows(CHAIN, state, np.eye(6) * 1e-6, 8.0) is None


@given(st.floats(1.2, 19.0), st.floats(-2.9, 2.9), st.floats(-0.6, 0.6))
@settings(max_examples=60, deadline=None)
def test_follow_up_puts_a_point_at_opposite_columns(distance, bearing, height):
    point = np.array([distance * np.cos(bearing), distance * np.sin(bearing), height])
    head = pointing_at(CHAIN, point)
    uv = CHAIN.model.project(CHAIN.site_ih(head).inverse().apply(point[None]))[:, 0]
    off = uv - CHAIN.model.principal_px
    assert abs(off[0, 0] + off[1, 0]) < 1.0
    assert abs(off[0, 1] + off[1, 1]) < 1.0
    assert off_middle_rad(CHAIN, head, point) < 1e-6


def test_follow_up_stays_within_the_heads_limits():
    pan, tilt = pointing_at(CHAIN, np.array([-0.2, -0.001, 0.0]))
    limits = RigCalibration().head
    assert abs(pan) <= limits.pan_limit_rad
    assert tilt == limits.tilt_limits_rad[1]
    assert np.isfinite(pointing_at(CHAIN, np.array([0.0, 0.0, 0.0]))).all()


def test_overlap_ends_where_one_camera_ends():
    head = pointing_at(CHAIN, np.array([3.0, 0.0, 0.1]))
    assert in_overlap(CHAIN, head, np.array([[3.0, 0.0, 0.1], [3.0, 0.2, 0.1]]))
    assert not in_overlap(CHAIN, head, np.array([[3.0, 0.0, 0.1], [3.0, 0.7, 0.1]]))
    with pytest.raises(ValueError, match=r"point_site_m: got shape \(2,\), expected \(3\)"):
        pointing_at(CHAIN, np.array([1.0, 2.0]))


def test_pairs_grow_with_range_and_with_a_slanting_view():
    rig = RigCalibration()
    counts = [pairs_needed(filter_snr_per_pair(rig, PlateView(r, 0.5))) for r in (1.6, 3.0, 5.0, 10.0)]
    assert counts == sorted(set(counts))
    slant = pairs_needed(filter_snr_per_pair(rig, PlateView(5.0, 0.05)))
    assert slant > pairs_needed(filter_snr_per_pair(rig, PlateView(5.0, 0.9)))
    assert pairs_needed(0.0) == np.inf


def test_brightest_pixel_has_snr_1_where_the_calibration_says():
    rig = RigCalibration()
    spread = marker_spread(rig, rig.sensor.snr_1_range_m)
    filtered = filter_snr_per_pair(rig, PlateView(rig.sensor.snr_1_range_m, 1.0))
    assert filtered * spread.peak / np.sqrt(spread.energy) == pytest.approx(1.0)


def test_view_angle_opens_when_the_cabin_leans_towards_the_head():
    away = Transform(exp_map(np.array([0, 0, 0.0])), np.array([4.0, 0.0, 0.0]))
    head = pointing_at(CHAIN, away.position_m)
    flat, leaning = (plate_view(CHAIN, ChainState(away, head, (0.0, cabin))) for cabin in (0.0, 0.6))
    assert leaning.cosine > flat.cosine + 0.3
