"""The fallback on outlines, as the localizer uses it, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from executive.core.ports import LocaliseRequest
from executive.core.types import (
    HeadReading,
    Images,
    Outcome,
    Point,
    Quality,
    Reason,
    Segment,
)
from perception.frames.routine import Routine
from perception.geometry.rotation import log_map, matrix_from_quat, quat_from_matrix
from perception.localizer.aim import Aim
from perception.localizer.empty_views import EmptyView, EmptyViews
from perception.localizer.localizer import LedStereoLocalizer
from perception.localizer.outlines import OutlineFix, Outlines
from perception.localizer.scouting import UNLIT
from tests.perception.passive_trials import Wrong, draw
from tests.perception.robot import After, Robot
from tests.perception.synthetic import scene

ALL = {0, 1, 2, 3}
AHEAD_M = 0.7


def robot(range_m=4.0, seed=1):
    return Robot(scene(range_m, bearing=0.0), np.random.default_rng(seed), geometric=True)


def localizer(r):
    return LedStereoLocalizer(devices=r.devices, rig=r.chain.rig, clock=r.clock)


def sideways(r):
    x, y, _ = r.state.site_body.position_m
    return Segment(Point(x, y), Point(x, y + AHEAD_M), 0.03, 0.25, 0.03)


def moved(r, way_m):
    body = r.state.site_body
    r.state = replace(
        r.state, site_body=replace(body, position_m=body.position_m + np.array([0.0, way_m, 0.0]))
    )


def ask(r, predicted=None, segment=None):
    return LocaliseRequest(Quality.PRECISE, predicted or r.predicted(), 900.0, segment)


def seen_ahead(**settings):
    """A robot that looked along its way, drove to its end, and lost its lights."""
    r = robot(**settings)
    found = localizer(r)
    assert r.run(found.locate(ask(r, segment=sideways(r)))).ok
    moved(r, AHEAD_M)
    r.hidden = ALL
    return r, found


def unlit(r):
    return [shot for shot in r.shots if shot.leds == UNLIT]


def test_the_way_ahead_is_looked_at_once():
    r = robot()
    found = localizer(r)
    outcome = r.run(found.locate(ask(r, segment=sideways(r))))
    assert outcome.value.pose.source == "markers"
    assert 1 <= len(unlit(r)) <= 2
    looks = len(unlit(r))
    r.run(found.locate(ask(r, segment=sideways(r))))
    assert len(unlit(r)) == looks


def test_without_a_segment_or_a_sure_place_nothing_is_looked_at():
    r = robot()
    r.run(localizer(r).locate(ask(r)))
    r.run(localizer(r).locate(ask(r, r.predicted(sigma_m=0.2), sideways(r))))
    assert not unlit(r)


def test_a_look_ahead_that_fails_spoils_no_fix_and_is_not_tried_again_at_once():
    r = robot()
    take, tried = r.take, []

    def refuse(shot):
        if shot.leds != UNLIT:
            return take(shot)
        tried.append(shot)
        return After(r.clock, r.clock.now_s, Outcome(Reason.DEVICE, "no frames"))

    r.take = refuse
    found = localizer(r)
    for _ in range(2):
        assert r.run(found.locate(ask(r, segment=sideways(r)))).ok
    assert len(tried) == 1


def test_a_dark_rover_is_found_by_its_outline_where_the_ground_was_seen_before():
    r, found = seen_ahead()
    outcome = r.run(found.locate(ask(r, r.predicted((0.03, -0.02), 0.05))))
    assert outcome.ok
    assert outcome.value.pose.source == "passive"
    assert outcome.value.pose.markers == 0
    body = r.state.site_body
    turn = log_map(body.rotation @ matrix_from_quat(outcome.value.pose.quat_site_body).T)
    off = np.concatenate([body.position_m - np.array(outcome.value.pose.position_site_m), turn])
    assert off @ np.linalg.solve(outcome.value.pose.covariance, off) < 22
    assert "outline against the view of" in outcome.detail
    assert "0 of 4 markers" in outcome.detail


def test_markers_that_show_are_never_replaced():
    r, found = seen_ahead()
    r.hidden = set()
    assert r.run(found.locate(ask(r))).value.pose.source == "markers"


def test_a_place_never_seen_empty_is_refused_in_words():
    r, found = seen_ahead()
    moved(r, -AHEAD_M)
    outcome = r.run(found.locate(ask(r)))
    assert outcome.reason is Reason.NOT_SEEN
    assert "this place was not seen without the rover" in outcome.detail


def test_an_uncertain_place_is_not_sought_by_outline():
    r, found = seen_ahead()
    outcome = r.run(found.locate(ask(r, r.predicted(sigma_m=0.4))))
    assert outcome.reason is Reason.NOT_SEEN
    assert "no outline sought: the rover may be" in outcome.detail


def test_an_outline_far_from_a_sure_prediction_is_refused():
    r, found = seen_ahead()
    outcome = r.run(found.locate(ask(r, r.predicted((0.06, 0.06), sigma_m=0.005))))
    assert outcome.reason is Reason.NOT_SEEN
    assert "from the prediction" in outcome.detail


def test_an_outline_out_of_sight_is_refused():
    r, found = seen_ahead()
    r.outline = False
    outcome = r.run(found.locate(ask(r)))
    assert outcome.reason is Reason.NOT_SEEN
    assert "no outline shows" in outcome.detail


# -- images of the full tier


@pytest.fixture(scope="module")
def setting():
    return draw(5.0, Wrong.NOTHING, np.random.default_rng(3))


def in_frames(stacks, windows):
    """Full frames that show these stacks in their windows, and nothing around."""
    whole = []
    for frames, w in zip(stacks, windows, strict=True):
        full = np.full((len(frames), 1024, 1024), np.median(frames), dtype=np.uint16)
        full[:, w.v : w.v + w.height, w.u : w.u + w.width] = frames
        whole.append(full)
    return whole


def in_images(setting, images=None):
    """What comes of images (those of the setting) against its empty views."""
    state = setting.expectation.state
    empty = in_frames(setting.backgrounds, setting.windows)
    full = in_frames(images or setting.images, setting.windows)
    views = EmptyViews(setting.chain)
    mean = tuple(np.rint(16 * frames.mean(axis=0)).astype(np.uint16) for frames in empty)
    views.add(EmptyView(5.0, state.head_rad, np.full((2, 4), np.nan), mean))
    r = robot()
    r.state = state

    def take(shot):
        head = HeadReading(0.0, *state.head_rad, moving=False)
        counts = tuple(
            f[:, w.v : w.v + w.height, w.u : w.u + w.width] for f, w in zip(full, shot.windows, strict=True)
        )
        return After(r.clock, 0.0, Outcome(Reason.DONE, value=Images(6.0, shot, shot.windows, counts, head)))

    r.take = take
    aim = Aim(r.devices, setting.chain, r.clock)
    outlines = Outlines(r.devices, setting.chain, r.clock, aim, views)
    body = state.site_body
    predicted = replace(
        robot().predicted(sigma_m=0.087, sigma_heading=0.1),
        position_site_m=tuple(body.position_m),
        quat_site_body=quat_from_matrix(body.rotation),
    )
    return r.run(Routine(outlines.find(predicted, 100.0)))


def test_in_images_the_outline_gives_the_pose(setting):
    found = in_images(setting)
    assert isinstance(found, OutlineFix)
    off = setting.body.position_m - np.array(found.pose.position_site_m)
    assert np.linalg.norm(off) < 0.05
    assert found.pose.source == "passive"


def test_frames_that_are_no_two_alike_are_refused(setting):
    jolted = [np.stack([np.roll(f, 12 * (i == 4), axis=1) for i, f in enumerate(s)]) for s in setting.images]
    found = in_images(setting, jolted)
    assert isinstance(found, str)
    assert "left camera" in found


def test_one_camera_that_sees_nothing_is_refused(setting):
    dark = [setting.images[0], np.zeros_like(setting.images[1])]
    assert isinstance(in_images(setting, dark), str)
