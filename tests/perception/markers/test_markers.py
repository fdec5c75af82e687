"""Detection and centres of single markers, in noise of known size."""

import numpy as np
import pytest

from executive.core.rig import RigCalibration
from perception.frames.psf import marker_spread
from perception.markers.centres import detection_threshold, find_markers
from perception.markers.fisher import centre_bound
from tests.perception.synthetic import spot

RIG = RigCalibration()
ONES = np.ones((60, 64), dtype=np.float32)


def noisy(rng, range_m, snr, u=30.3, v=28.7, shape=(60, 64)):
    flux = snr / np.sqrt(marker_spread(RIG, range_m).energy)
    return (flux * spot(shape, u, v, range_m) + rng.standard_normal(shape)).astype(np.float32), flux


@pytest.mark.parametrize("range_m", [1.6, 3.0, 7.5, 20.0])
def test_expected_spread_matches_an_independent_integration(range_m):
    kernel = marker_spread(RIG, range_m).kernel()
    middle = (len(kernel) - 1) / 2
    np.testing.assert_allclose(kernel, spot(kernel.shape, middle, middle, range_m, grid=41), atol=2e-4)


@pytest.mark.parametrize("range_m", [1.6, 3.0, 5.0])
def test_centre_error_reaches_the_bound_and_its_covariance_is_true(range_m):
    rng, spread = np.random.default_rng(1), marker_spread(RIG, range_m)
    error, normal, flux = [], [], 0.0
    for _ in range(300):
        u, v = 30 + rng.uniform(-0.5, 0.5, 2)
        image, flux = noisy(rng, range_m, 10.0, u, v)
        found = find_markers(image, ONES, spread)[0]
        off = found.uv_px - [u, v]
        error.append(off @ off)
        normal.append(off @ np.linalg.solve(found.covariance_px2, off))
    least = np.trace(centre_bound(spread, flux, 1.0, np.array([0.2, 0.2])))
    assert np.sqrt(np.mean(error) / least) < 1.1
    assert np.mean(normal) == pytest.approx(2.0, abs=0.3)


def test_false_alarms_come_at_the_rate_asked_for():
    rng, spread = np.random.default_rng(2), marker_spread(RIG, 3.0)
    alarms = sum(
        bool(find_markers(rng.standard_normal(ONES.shape).astype(np.float32), ONES, spread, (0, 0), 0.1))
        for _ in range(400)
    )
    assert 10 <= alarms <= 60  # 40 expected; neighbouring pixels share noise, so rather fewer


def test_a_marker_of_snr_8_is_found_every_time():
    rng, spread = np.random.default_rng(3), marker_spread(RIG, 5.0)
    assert all(find_markers(noisy(rng, 5.0, 8.0)[0], ONES, spread) for _ in range(200))


def test_brightest_candidate_comes_first_and_the_corner_is_added():
    rng, spread = np.random.default_rng(4), marker_spread(RIG, 3.0)
    image, flux = noisy(rng, 3.0, 12.0)
    image += (2 * flux * spot(image.shape, 50.0, 10.0, 3.0)).astype(np.float32)
    found = find_markers(image, ONES, spread, (100, 200))
    np.testing.assert_allclose(found[0].uv_px, [150.0, 210.0], atol=0.5)
    np.testing.assert_allclose(found[1].uv_px, [130.3, 228.7], atol=0.5)


def test_a_dark_spot_is_no_marker():
    image, flux = noisy(np.random.default_rng(5), 3.0, 0.0)
    image -= (30 * spot(image.shape, 30.0, 30.0, 3.0)).astype(np.float32)
    near = [d for d in find_markers(image, ONES, marker_spread(RIG, 3.0)) if np.hypot(*(d.uv_px - 30)) < 3]
    assert not near
    assert flux == 0.0


def test_threshold_rises_with_the_window():
    assert detection_threshold(1_000_000, 1e-3) > detection_threshold(1000, 1e-3) > 4.0


def test_wrong_images_are_refused():
    spread = marker_spread(RIG, 3.0)
    with pytest.raises(ValueError, match=r"got an image of shape \(3, 3\)"):
        find_markers(ONES[:3, :3], ONES[:3, :3], spread)
    with pytest.raises(ValueError, match="non-finite"):
        find_markers(ONES * np.nan, ONES, spread)
    with pytest.raises(ValueError, match="noise of 0"):
        find_markers(ONES, ONES * 0, spread)
    with pytest.raises(ValueError, match="range_m: got -1"):
        marker_spread(RIG, -1)
    with pytest.raises(ValueError, match="0 pixels"):
        detection_threshold(0, 0.1)
