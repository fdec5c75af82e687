"""Faults of the cameras and sensors, on both kinds of answers: images and marker centres."""

from dataclasses import replace

import numpy as np
import pytest

from executive.core.devices import CAMERAS
from executive.core.types import Reason, Shot
from proving.faults.cameras import (
    CameraDead,
    FrozenFrame,
    LateFrame,
    Lateness,
    MissingFrame,
    SwappedCameras,
)
from proving.faults.parameters import Nothing, OneCamera
from proving.faults.sensors import (
    FULL_COUNTS,
    CalibrationDrift,
    Drift,
    ExposureFactor,
    ExposureOff,
    HotPixelCount,
    HotPixels,
)
from tests.proving.faults.bench import SHOT, WINDOWS

ALTERING = [
    CameraDead(OneCamera(camera="left")),
    FrozenFrame(Nothing()),
    SwappedCameras(Nothing()),
    ExposureOff(ExposureFactor(factor=0.2)),
    CalibrationDrift(Drift(camera="right")),
]


@pytest.mark.parametrize("fault", ALTERING, ids=lambda f: type(f).__name__)
@pytest.mark.parametrize("tier", ["centres", "images"])
def test_an_altered_answer_is_evidence_and_an_untouched_one_is_none(bench, fault, tier):
    fault.altered = 0
    bench.level.now = 0.0
    before, after = getattr(bench, tier)(fault)
    assert not fault.took_effect()
    bench.level.now = 1.0
    before, after = getattr(bench, tier)(fault)
    assert fault.took_effect()
    assert (after.time_s, after.shot) == (before.time_s, before.shot)


def test_a_dead_camera_shows_nothing_and_the_other_everything(bench):
    fault = CameraDead(OneCamera(camera="right"))
    before, after = bench.centres(fault)
    assert np.isnan(after.uv_px[1]).all()
    assert (after.uv_px[0] == before.uv_px[0]).all()
    before, after = bench.images(fault)
    assert not after.counts[1].any()
    assert after.counts[0] is before.counts[0]


def test_a_frozen_frame_shows_no_marker_in_the_geometric_tier(bench):
    _, after = bench.centres(FrozenFrame(Nothing()))
    assert np.isnan(after.uv_px).all()


def test_a_frozen_frame_is_the_first_of_its_shot_over_and_over(bench):
    before, after = bench.images(FrozenFrame(Nothing()))
    for camera in (0, 1):
        assert after.counts[camera].shape == before.counts[camera].shape
        assert (after.counts[camera] == before.counts[camera][0]).all()
        assert (before.counts[camera][1:, 15, 18] != before.counts[camera][0, 15, 18]).all()


def test_a_late_frame_is_held_back_and_keeps_its_time(bench):
    fault = LateFrame(Lateness(by="30 s"))
    action = bench.around(fault)[CAMERAS].take(SHOT)
    taken = bench.finish(action)
    now_s = bench.robot.clock.now_s
    assert taken.value.time_s == now_s - 30.0
    assert fault.took_effect()
    assert action.poll() is taken


def test_a_late_frame_can_be_given_up(bench):
    action = bench.around(LateFrame(Lateness(by="30 s")))[CAMERAS].take(SHOT)
    for _ in range(10):
        action.poll()
        bench.robot.advance()
    action.cancel()
    assert action.poll().reason is Reason.CANCELLED


def test_a_missing_frame_is_a_failure_of_the_device(bench):
    fault = MissingFrame(Nothing())
    outcome = bench.finish(bench.around(fault)[CAMERAS].take(SHOT))
    assert (outcome.reason, outcome.value) == (Reason.DEVICE, None)
    assert fault.took_effect()


def test_swapped_cameras_answer_for_each_other(bench):
    before, after = bench.centres(SwappedCameras(Nothing()))
    assert (after.uv_px == before.uv_px[::-1]).all()
    assert (after.sigma_px == before.sigma_px[::-1]).all()


def test_a_swapped_camera_reads_out_the_window_meant_for_the_other(bench):
    before, after = bench.images(SwappedCameras(Nothing()))
    assert after.windows == WINDOWS
    assert (after.counts[0] == before.counts[1]).all()
    assert (after.counts[1] == before.counts[0]).all()


@pytest.mark.parametrize(
    ("factor", "level", "brightest"), [(0.2, 1.0, 80), (5.0, 1.0, 1023), (0.25, 0.5, 200)]
)
def test_exposure_scales_and_clips_the_counts(bench, factor, level, brightest):
    bench.level.now = level
    _, after = bench.images(ExposureOff(ExposureFactor(factor=factor)))
    assert after.counts[0][0].max() == brightest


def test_in_the_dark_the_centres_are_worse_and_at_last_lost(bench):
    before, after = bench.centres(ExposureOff(ExposureFactor(factor=0.5)))
    assert (after.sigma_px == 2 * before.sigma_px).all()
    assert np.isnan(bench.centres(ExposureOff(ExposureFactor(factor=0.01)))[1].uv_px).all()


def test_no_marker_shows_against_saturated_ground(bench):
    assert np.isnan(bench.centres(ExposureOff(ExposureFactor(factor=4.0)))[1].uv_px).all()


def test_hot_pixels_stay_where_they_are_in_every_frame(bench):
    fault = HotPixels(HotPixelCount(count=50_000))
    _, after = bench.images(fault)
    hot = after.counts[0] == FULL_COUNTS
    assert 0.02 < hot.mean() < 0.08  # 5 % of a million pixels
    assert (hot == hot[0]).all()
    assert fault.took_effect()


def test_a_marker_over_a_hot_pixel_is_lost_and_the_others_are_not(bench):
    fault = HotPixels(HotPixelCount(count=1))
    before, _ = bench.centres(fault)
    bench.answering(fault, before)  # draws the pixels
    fault._uv_px[0, 0] = before.uv_px[0, 2] + 1.0
    after = fault.centres(before, 1.0)
    lost = np.isnan(after.uv_px).any(axis=-1)
    assert lost[0].tolist() == [False, False, True, False]
    assert not lost[1].any()


def test_a_drifted_camera_sees_everything_shifted_in_both_tiers(bench):
    fault = CalibrationDrift(Drift(camera="left", u=3.0, v=-2.0))
    before, after = bench.centres(fault)
    assert after.uv_px[0] - before.uv_px[0] == pytest.approx(np.tile([3.0, -2.0], (4, 1)))
    assert (after.uv_px[1] == before.uv_px[1]).all()
    before, after = bench.images(fault)
    assert after.counts[0][1, 13, 21] == before.counts[0][1, 15, 18]
    assert (after.counts[1] == before.counts[1]).all()


def test_a_drift_that_scales_leaves_the_middle_of_the_frame_where_it_is():
    fault = CalibrationDrift(Drift(camera="left", u=0.0, scale=1.1))
    affine = fault._affine(1.0)
    assert affine @ [511.5, 511.5, 1.0] == pytest.approx([511.5, 511.5])
    assert affine @ [611.5, 511.5, 1.0] == pytest.approx([621.5, 511.5])
    in_window = fault._affine(1.0, (100, 200))
    assert in_window @ [411.5, 311.5, 1.0] == pytest.approx([411.5, 311.5])


def test_motion_fragments_are_not_lost_to_faults_of_the_markers(bench):
    dark = replace(SHOT, leds=(0, 0))
    for fault in (ExposureOff(ExposureFactor(factor=0.3)), HotPixels(HotPixelCount(count=200_000))):
        _, after = bench.centres(fault, Shot(dark.leds))
        assert np.isfinite(after.uv_px).all()
