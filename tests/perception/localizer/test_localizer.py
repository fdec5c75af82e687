"""The localizer as an action over a synthetic robot, in both tiers."""

import numpy as np
import pytest

from executive.core.ports import LocaliseRequest
from executive.core.types import (
    Centres,
    Outcome,
    PoseSource,
    Quality,
    Reason,
)
from perception.frames.codes import is_coded
from perception.geometry.rotation import log_map, matrix_from_quat
from perception.localizer.localizer import LedStereoLocalizer
from tests.perception.robot import After, Robot
from tests.perception.synthetic import scene


def robot(range_m=3.0, seed=1, **settings):
    return Robot(
        scene(range_m, joints=settings.pop("joints", (0.0, 0.0))), np.random.default_rng(seed), **settings
    )


def localizer(robot):
    return LedStereoLocalizer(devices=robot.devices, rig=robot.chain.rig, clock=robot.clock)


def nees(pose, robot):
    body = robot.state.site_body
    turn = log_map(body.rotation @ matrix_from_quat(pose.quat_site_body).T)
    off = np.concatenate([body.position_m - np.array(pose.position_site_m), turn])
    return off @ np.linalg.solve(pose.covariance, off)


@pytest.mark.parametrize("geometric", [False, True], ids=["images", "centres"])
@pytest.mark.parametrize("range_m", [1.6, 3.0, 5.0])
def test_a_wrong_prediction_is_mended_to_within_the_fixs_own_covariance(range_m, geometric):
    r = robot(range_m, geometric=geometric)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted((0.03, -0.02), 0.06))))
    assert outcome.reason is Reason.DONE
    assert outcome.value.pose.source == "markers"
    assert outcome.value.pose.markers >= 3
    assert nees(outcome.value.pose, r) < 22  # 99.9 %
    assert outcome.value.pose.sigma_position_m < 0.004


def test_more_pairs_are_taken_far_away():
    counts = []
    for range_m in (1.6, 3.0, 5.0):
        r = robot(range_m)
        r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
        counts.append(r.shots[0].leds.count(1))
    assert counts == sorted(set(counts))


@pytest.mark.parametrize("geometric", [False, True], ids=["images", "centres"])
def test_precise_does_not_end_where_single_markers_do(geometric):
    r = robot(12.0, geometric=geometric, joints=(0.0, 1.0))
    outcome = r.run(
        localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted((0.05, -0.03), 0.1, 0.05, 0.1)))
    )
    assert outcome.ok
    assert outcome.value.pose.markers == 4
    assert nees(outcome.value.pose, r) < 22
    assert is_coded(r.shots[0].leds)
    frames = sum(len(shot.leds) for shot in r.shots)
    assert f" pairs, {frames} frames in {frames / 2:.0f} s" in outcome.detail


def test_far_asks_for_more_pairs_than_precise_and_gets_nearer():
    sigmas = {}
    for quality in (Quality.PRECISE, Quality.FAR):
        r = robot(12.0, geometric=True, joints=(0.0, 1.0))
        outcome = r.run(localizer(r).locate(LocaliseRequest(quality, r.predicted())))
        sigmas[quality] = sum(len(shot.leds) for shot in r.shots)
        assert outcome.ok
    assert sigmas[Quality.FAR] > 1.5 * sigmas[Quality.PRECISE]


def test_an_accuracy_asked_for_replaces_that_of_the_quality():
    frames = {}
    for position_m in (0.0, 0.012, 0.1):
        r = robot(12.0, geometric=True, joints=(0.0, 1.0))
        request = LocaliseRequest(Quality.PRECISE, r.predicted(), position_sigma_m=position_m)
        assert r.run(localizer(r).locate(request)).ok
        frames[position_m] = sum(len(shot.leds) for shot in r.shots)
    assert frames[0.1] <= frames[0.0] < frames[0.012]


def test_every_answer_says_what_it_cost():
    for hidden in (set(), {0, 1, 2, 3}):
        r = robot(geometric=True, hidden=hidden)
        request = LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=300.0)
        outcome = r.run(localizer(r).locate(request))
        frames = sum(len(shot.leds) for shot in (*r.shots, *r.pictures))
        assert outcome.detail.endswith(f"{frames} frames, {r.clock.now_s:.0f} s in all")


def test_pairs_are_added_until_the_pose_is_as_good_as_wanted():
    r = robot(14.0, joints=(0.0, 1.0), brightness=0.8)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert outcome.ok
    assert len(r.shots) >= 2
    assert outcome.value.pose.sigma_position_m < 0.033
    assert nees(outcome.value.pose, r) < 22


def test_a_dead_marker_is_done_without_far_away_too():
    r = robot(9.0, joints=(0.0, 1.0), hidden={2})
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted((0.02, 0.0)))))
    assert outcome.ok
    assert outcome.value.pose.markers == 3
    assert nees(outcome.value.pose, r) < 22


@pytest.mark.parametrize("swap", [{0: 1, 1: 0}, {0: 2, 2: 0}])
def test_swapped_identities_far_away_give_no_false_pose(swap):
    r = robot(9.0, joints=(0.0, 1.0), swapped=swap)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=200.0)))
    assert not outcome.ok or nees(outcome.value.pose, r) < 25


def test_no_light_far_away_is_not_seen_within_budget():
    r = robot(12.0, geometric=True, joints=(0.0, 1.0), hidden={0, 1, 2, 3})
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=900.0)))
    assert outcome.reason is Reason.NOT_SEEN
    assert r.clock.now_s <= 900.0


def test_a_flat_plate_at_twenty_metres_is_a_poor_view():
    r = robot(20.0, geometric=True, hidden={0, 1, 2, 3})
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=900.0)))
    assert outcome.reason is Reason.POOR_VIEW


def test_the_head_turns_to_the_prediction_only_when_needed():
    r = robot()
    found = localizer(r)
    r.run(found.locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    r.moves = 0
    r.run(found.locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert r.moves == 0
    r.state = type(r.state)(r.state.site_body, (r.state.head_rad[0] + 0.3, 0.1), r.state.joints_rad)
    outcome = r.run(found.locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert r.moves == 1
    assert outcome.ok


@pytest.mark.parametrize("dark", [{1}, {0, 2}])
def test_dead_markers_are_done_without(dark):
    r = robot(hidden=dark)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted((0.01, 0.0)))))
    assert outcome.ok
    assert outcome.value.pose.markers == 4 - len(dark)
    assert nees(outcome.value.pose, r) < 22


def test_no_light_at_all_is_not_seen_after_a_search_within_budget():
    r = robot(geometric=True, hidden={0, 1, 2, 3})
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=900.0)))
    assert outcome.reason is Reason.NOT_SEEN
    assert "0 of 4 markers" in outcome.detail
    assert r.moves >= 8
    assert r.clock.now_s <= 900.0


def test_a_rover_outside_the_view_is_found_by_the_search_pattern():
    r = robot(geometric=True)
    predicted = r.predicted((0.1, 0.75), sigma_m=0.6, sigma_heading=1.0)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, predicted, budget_s=900.0)))
    assert outcome.ok
    assert nees(outcome.value.pose, r) < 22


def test_a_plate_seen_from_behind_is_a_poor_view():
    r = robot(5.0, joints=(0.0, 0.0), geometric=True, hidden={0, 1, 2, 3})
    leaning = scene(5.0, turn=(0.0, 0.6, 0.0), bearing=0.0)
    r.state = leaning.state
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=300.0)))
    assert outcome.reason is Reason.POOR_VIEW
    assert "off the plate's normal" in outcome.detail


def test_a_fix_far_from_a_sure_prediction_is_taken_twice_then_refused():
    r = robot()
    predicted = r.predicted((0.15, 0.1), sigma_m=0.01)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, predicted)))
    assert outcome.reason in (Reason.IMPLAUSIBLE, Reason.NOT_SEEN)
    r = robot(geometric=True)
    request = LocaliseRequest(Quality.PRECISE, r.predicted((0.15, 0.1), sigma_m=0.01))
    outcome = r.run(localizer(r).locate(request))
    assert outcome.reason is Reason.IMPLAUSIBLE
    assert len(r.shots) == 2
    assert "mm and" in outcome.detail
    assert nees(outcome.value.pose, r) < 22


def test_the_same_fix_is_accepted_when_the_prediction_is_wide():
    r = robot(geometric=True)
    predicted = r.predicted((0.15, 0.1), sigma_m=0.7)
    assert r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, predicted))).ok


@pytest.mark.parametrize("swap", [{0: 1, 1: 0}, {0: 2, 2: 0}])
def test_swapped_identities_give_no_false_pose(swap):
    r = robot(swapped=swap)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert nees(outcome.value.pose, r) < 25 if outcome.ok else outcome.reason is Reason.IMPLAUSIBLE


def test_jolted_images_are_taken_again_then_reported():
    def jolt(stack):
        stack[len(stack) // 2] = np.roll(stack[len(stack) // 2], 9, axis=1)
        return stack

    r = robot(spoil=jolt)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert outcome.reason is Reason.UNSTABLE_IMAGES
    assert len(r.shots) == 2


@pytest.mark.parametrize("range_m", [3.0, 10.0])
def test_fewer_frames_than_ordered_are_the_cameras_failure(range_m):
    r = robot(range_m)
    r.spoil = lambda stack: stack[:-1]
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert outcome.reason is Reason.DEVICE
    assert "got frames of shape" in outcome.detail


def test_a_slow_drift_of_light_does_no_harm():
    r = robot(light_per_frame=0.001)
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert outcome.ok
    assert nees(outcome.value.pose, r) < 22


def test_a_silent_camera_times_out_and_is_cancelled():
    r = robot()
    silent = After(r.clock, np.inf, Outcome(Reason.DONE))
    r.take = lambda shot: silent
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=50.0)))
    assert outcome.reason is Reason.TIMEOUT
    assert silent.cancelled


def test_a_failed_device_is_named_with_its_reason():
    r = robot()
    r.take = lambda shot: After(r.clock, 0.0, Outcome(Reason.DEVICE, "no frames"))
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted())))
    assert outcome.reason is Reason.DEVICE
    assert "cameras: no frames" in outcome.detail


def test_cancelling_cancels_the_exposure_under_way():
    r = robot()
    action = localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted()))
    assert action.poll() is None
    action.cancel()
    assert action.poll().reason is Reason.CANCELLED
    assert r.actions[-1].cancelled


def test_too_short_a_budget_ends_without_a_look():
    r = robot()
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=1.0)))
    assert outcome.reason is Reason.NOT_SEEN
    assert "no time" in outcome.detail
    assert not r.shots


def test_trend_from_centroids_is_coarse_and_honest():
    r = robot(geometric=True)
    rng, values = np.random.default_rng(3), []

    def centroid(shot):
        middle = r.state.site_body.position_m + r.state.site_body.rotation @ [0.0, 0.0, 0.065]
        head = r.chain.site_ih(r.state.head_rad)
        uv = np.full((2, 4, 2), np.nan)
        true_px = r.chain.model.project(head.inverse().apply(middle[None]))[:, 0]
        uv[:, 0] = true_px + 2 * rng.standard_normal((2, 2))
        data = Centres(r.clock.now_s, shot, uv, np.full((2, 4), 2.0), r.head_reading())
        return After(r.clock, r.clock.now_s + 20, Outcome(Reason.DONE, value=data))

    r.take = centroid
    for _ in range(20):
        outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.TREND, r.predicted((0.05, 0.02)))))
        assert outcome.value.pose.source == PoseSource.TREND
        off = (np.array(outcome.value.pose.position_site_m) - r.state.site_body.position_m)[:2]
        values.append(off @ np.linalg.solve(outcome.value.pose.covariance[:2, :2], off))
        assert 0.003 < outcome.value.pose.sigma_position_m < 0.05
        assert outcome.value.pose.time_s == r.clock.now_s - 10.0
    assert np.mean(values) < 3.0


def test_trend_without_motion_is_not_seen():
    r = robot()
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.TREND, r.predicted())))
    assert outcome.reason is Reason.NOT_SEEN
    assert r.shots[0].leds == (0, 0)


def test_a_fix_carries_what_both_cameras_saw():
    r = robot()
    seen = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted()))).value
    assert len(seen.views) == 2
    for view in seen.views:
        assert view.counts.shape == (view.window.height, view.window.width)
        assert np.nanmax(np.abs(view.detected_px - view.reprojected_px)) < 1.5


def test_a_failure_carries_what_was_looked_at():
    r = robot(hidden={0, 1, 2, 3})
    outcome = r.run(localizer(r).locate(LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=100.0)))
    assert outcome.reason is Reason.NOT_SEEN
    assert "no outline sought" in outcome.detail
    assert outcome.value.pose is None
    assert len(outcome.value.views) == 2
    assert np.isnan(outcome.value.views[0].reprojected_px).all()


def test_nothing_is_carried_over_from_an_earlier_look():
    r = robot()
    found = localizer(r)
    assert r.run(found.locate(LocaliseRequest(Quality.PRECISE, r.predicted()))).value.views
    request = LocaliseRequest(Quality.PRECISE, r.predicted(), budget_s=1.0)
    assert r.run(found.locate(request)).value.views == ()
