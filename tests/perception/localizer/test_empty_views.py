"""What a view shows of a place without the rover, and where to look for what no view shows."""

import numpy as np
import pytest

from executive.core.rig import RigCalibration
from executive.core.types import (
    Images,
    Point,
    PoseEstimate,
    PoseSource,
    Segment,
    Shot,
    Window,
)
from perception.geometry.chain import Chain
from perception.geometry.follow_up import pointing_at
from perception.geometry.prediction import expect
from perception.localizer.empty_views import (
    GHOST_M,
    MOST,
    REACH_M,
    EmptyView,
    EmptyViews,
    boxes_px,
)
from perception.localizer.scouting import places_ahead

CHAIN = Chain.of(RigCalibration())
FULL = (Window(0, 0, 1024, 1024),) * 2


def pose(x, y, sigma_m=0.02):
    covariance = np.diag([sigma_m**2] * 2 + [1e-4] + [1e-4] * 3)
    return PoseEstimate(0.0, (x, y, 0.0), (0.0, 0.0, 0.0, 1.0), covariance, PoseSource.PREDICTION)


def view(rover, looking_at, time_s=0.0):
    head_rad = pointing_at(CHAIN, np.array([*looking_at, 0.0]))
    return EmptyView.before(CHAIN, time_s, head_rad, (*rover, 0.0))


def shows(one, x, y):
    return bool(one.shows(CHAIN, np.array([[x, y, 0.0]]))[0])


def test_a_place_beside_the_rover_is_seen_empty_and_its_own_is_not():
    one = view((4.0, 0.0), (4.0, 0.3))
    assert shows(one, 4.0, 0.6)
    assert not shows(one, 4.0, 0.0)
    assert not shows(one, 4.0, 0.2)


def test_a_far_rover_hides_the_ground_behind_it():
    one = view((10.0, 0.0), (11.0, 0.0))
    assert not shows(one, 11.0, 0.0)
    assert not shows(one, 11.5, 0.0)
    assert shows(one, 15.0, 0.0)
    assert shows(one, 11.0, 0.8)


def test_a_place_out_of_either_frame_is_not_seen():
    one = view((2.0, 3.0), (4.0, 0.0))
    assert shows(one, 4.0, 0.0)
    assert not shows(one, 4.0, 0.9)
    assert not shows(one, -4.0, 0.0)


@pytest.mark.parametrize("rover", [(4.0, -0.6), (4.0, 0.6), (3.0, 0.0), (9.0, 0.0)])
def test_windows_hold_the_expected_rover_and_leave_out_where_it_was(rover):
    one = view(rover, (4.0, 0.0))
    assert shows(one, 4.0, 0.0)
    expectation = expect(CHAIN, pose(4.0, 0.0), one.head_rad, (0.0, 0.0), (0.0, 0.0))
    place = np.array([[4.0, 0.0, 0.0]])
    keep = boxes_px(CHAIN, one.head_rad, place, REACH_M)[:, 0]
    ghost = boxes_px(CHAIN, one.head_rad, np.array([[*rover, 0.0]]), GHOST_M)[:, 0]
    for camera, window in enumerate(one.windows(CHAIN, expectation)):
        first = np.array([window.u, window.v])
        last = first + np.array([window.width - 1, window.height - 1])
        assert (first <= keep[camera, :2]).all()
        assert (last >= keep[camera, 2:]).all()
        assert (last < ghost[camera, :2]).any() or (first > ghost[camera, 2:]).any()


def test_what_is_kept_of_images_is_their_mean_to_a_sixteenth_of_a_count():
    rng = np.random.default_rng(1)
    counts = tuple(rng.integers(0, 1024, (8, 1024, 1024), dtype=np.uint16) for _ in range(2))
    one = view((9.0, 0.0), (4.0, 0.0))
    kept = one.of(Images(0.0, Shot((0,) * 8), FULL, counts, None))
    windows = (Window(10, 20, 30, 40), Window(50, 60, 30, 40))
    for frames, empty, w in zip(counts, kept.counts(windows), windows, strict=True):
        mean = frames.mean(axis=0)[w.v : w.v + 40, w.u : w.u + 30]
        np.testing.assert_allclose(empty[0], mean, atol=1 / 32)


def test_the_latest_view_comes_first_and_the_oldest_makes_room():
    views = EmptyViews(CHAIN)
    for time_s in range(MOST + 3):
        views.add(view((4.0, -0.8), (4.0, 0.0), float(time_s)))
    found = [v.time_s for v in views.of((4.0, 0.0, 0.0))]
    assert found == [float(t) for t in range(MOST + 2, 2, -1)]


def test_places_lead_to_the_end_of_the_segment_and_around_it():
    segment = Segment(Point(2.0, 0.0), Point(3.0, 1.0), 0.03, 0.25, 0.03)
    places = places_ahead(pose(2.0, 0.0), segment)
    end = np.array([3.0, 1.0, 0.0])
    np.testing.assert_allclose(places[0], [2.0, 0.0, 0.0])
    last = int(np.argmin(np.linalg.norm(places - end, axis=1)))
    np.testing.assert_allclose(places[last], end)
    assert np.linalg.norm(np.diff(places[: last + 1], axis=0), axis=1).max() < 0.16
    np.testing.assert_allclose(places[last + 1 :].mean(axis=0), end, atol=1e-9)
    assert np.linalg.norm(places[last + 1 :] - end, axis=1).min() > 0.3
