"""What noise may climb to, and how wide a peak of faint light is: both against brute force."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from executive.core.rig import RigCalibration
from perception.frames.difference import Difference
from perception.frames.exposure import plate_view
from perception.frames.psf import marker_spread
from perception.geometry.chain import STATE_SIZE
from perception.geometry.pose import PoseReadings, Sighting
from perception.kernels.climb import point_at
from perception.markers.false_alarms import joint_threshold, log_distinct_poses, unit_information
from perception.markers.likelihood import (
    MarkerPatches,
    most_likely,
    place_of,
    task_of,
)
from perception.markers.posterior import posterior
from tests.perception.far_trials import draw
from tests.perception.synthetic import spot

NOTHING_SEEN = np.full((2, 4, 2), np.nan), np.full((2, 4, 2, 2), np.nan)


@pytest.fixture(scope="module")
def setting():
    return draw(15.0, np.random.default_rng(3), RigCalibration())


@pytest.fixture(scope="module")
def readings(setting):
    said = setting.said
    sighting = Sighting(*NOTHING_SEEN, said.head_rad, said.joints_rad, setting.tilt_rad)
    return PoseReadings.of(setting.true.chain, sighting, setting.expectation.surface)


@pytest.fixture(scope="module")
def spread(setting):
    return marker_spread(setting.true.chain.rig, plate_view(setting.true.chain, setting.said).range_m)


def threshold(setting, readings, spread, volume=0.1, rate=1e-3):
    return joint_threshold(setting.true.chain, setting.said, readings, spread, volume, rate)


def test_the_poses_told_apart_times_the_gaussian_tail_are_the_false_alarm_rate(setting, readings, spread):
    snr = threshold(setting, readings, spread)
    read = np.zeros((STATE_SIZE, STATE_SIZE))
    readings.add_to(setting.said, read, np.zeros(STATE_SIZE))
    poses = log_distinct_poses(unit_information(setting.true.chain, setting.said, spread), read, 0.1, snr)
    assert math.exp(poses) * ndtr(-snr) == pytest.approx(1e-3, rel=1e-6)


def test_a_hundred_times_the_region_needs_as_much_as_a_hundredth_of_the_rate(setting, readings, spread):
    far, seldom = (
        threshold(setting, readings, spread, volume=10.0),
        threshold(setting, readings, spread, rate=1e-5),
    )
    assert far == pytest.approx(seldom, abs=1e-6)
    assert far > threshold(setting, readings, spread) + 0.5


@pytest.mark.parametrize(("volume", "rate"), [(0.0, 1e-3), (math.nan, 1e-3), (0.1, 0.0), (0.1, 1.0)])
def test_a_region_without_volume_or_a_rate_that_is_none_is_refused(setting, readings, spread, volume, rate):
    with pytest.raises(ValueError, match="expected"):
        threshold(setting, readings, spread, volume, rate)


def test_the_covariance_of_a_faint_rover_allows_for_the_tails_of_its_peak(setting, readings, spread):
    """Against a chain of random steps over states and flux, which knows nothing of curvatures."""
    chain, state = setting.true.chain, setting.said
    exact = replace(readings, measured=readings.measured._replace(encoder_rad=state.angles_rad))
    patches, flux = _noiseless(chain, state, spread, snr=8.0)
    peak = most_likely(chain, patches, exact, state, np.full(4, flux), shared=True)
    mean, told = posterior(chain, patches, exact, peak, shared=True)

    walked = _walk(chain, patches, exact, peak, np.random.default_rng(5), 12000)
    free = [0, 1, 5]
    sigma = walked[:, free].std(axis=0)
    np.testing.assert_allclose(np.sqrt(np.diag(told))[free], sigma, rtol=0.15)
    assert (sigma > 1.04 * np.sqrt(np.diag(peak.covariance))[free]).all()  # than the peak's curvature says
    off = mean.site_body.position_m - peak.state.site_body.position_m
    assert (np.abs(off[:2] - walked[:, :2].mean(axis=0)) < 0.3 * sigma[:2]).all()


def _walk(chain, patches, readings, peak, rng, count):
    """Steps (count, 11) of state and flux from the peak, by Metropolis's rule."""
    task = task_of(chain, patches, readings, peak.flux_counts, shared=True)

    def value(s):
        return point_at(task, place_of(peak.state.moved(s[:10]), peak.flux_counts + s[10])).value / 2

    information = point_at(task, place_of(peak.state, peak.flux_counts)).information
    proposals = rng.multivariate_normal(np.zeros(11), 0.35 * np.linalg.inv(information), count)
    here, height, walked = np.zeros(11), value(np.zeros(11)), []
    for step, luck in zip(proposals, np.log(rng.random(count)), strict=True):
        there = value(here + step)
        if luck < there - height:
            here, height = here + step, there
        walked.append(here)
    return np.array(walked)


def _noiseless(chain, state, spread, snr):
    """Differences of unit noise that show exactly the markers, together at this SNR; their flux."""
    flux = snr / np.sqrt(8 * spread.energy)
    uv, _ = chain.project(state)
    corners = [tuple(int(x) for x in np.floor(c.min(axis=0)) - 20) for c in uv]
    images = []
    for camera, corner in zip(uv, corners, strict=True):
        spots = [
            flux * spot((60, 60), *(place - corner), plate_view(chain, state).range_m) for place in camera
        ]
        images.append(np.array(spots, dtype=np.float32))
    ones = np.ones_like(images[0])
    differences = [Difference(i, ones, ones[0], 100) for i in images]
    return MarkerPatches.of(differences, corners, spread, np.ones((2, 4))), flux
