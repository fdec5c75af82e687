"""A rover on its way in images of the full tier: where it is, how far it came, and when nothing is said."""

from dataclasses import replace

import numpy as np
import pytest

from executive.core.types import Window
from perception.frames.exposure import plate_view
from perception.outline.moving_rover import moving_rover
from tests.perception.motion_trials import Setting, draw, judge


def rng(*key: int) -> np.random.Generator:
    return np.random.default_rng([46, *key])


def look(range_m: float, *key: int, **how) -> Setting:
    """A setting on one of two grounds, as each costs a second."""
    return draw(range_m, rng(round(10 * range_m), *key), sites=2, **how)


def find(s: Setting):
    return moving_rover(s.chain, s.expectation, s.data, plate_view(s.chain, s.expectation.state).range_m)


@pytest.fixture(scope="module")
def at_five_metres() -> Setting:
    return look(5.0, 7)


@pytest.mark.parametrize("range_m", [3.0, 5.0, 10.0])
def test_a_rover_under_way_is_found_within_60_mm_for_all_vibration_and_shadow(range_m):
    trials = [judge(look(range_m, i), repeats=1) for i in range(4)]
    assert all(np.linalg.norm(t.error_m) < 0.060 for t in trials)
    nees = [t.error_m @ np.linalg.solve(t.covariance, t.error_m) for t in trials]
    assert np.mean(nees) < 8.0


def test_the_step_since_the_first_frame_is_told_with_its_direction(at_five_metres):
    found, s = find(at_five_metres), at_five_metres
    step = s.after.position_m - s.before.position_m
    off = found.step_m - step
    assert np.linalg.norm(off[:2]) < 0.012
    assert off @ np.linalg.solve(found.step_covariance, off) < 16.0


def test_the_regions_of_both_cameras_hold_the_rover(at_five_metres):
    s = at_five_metres
    head = s.chain.site_ih(s.expectation.state.head_rad)
    middle = s.after.apply(np.array([[0.0, 0.0, 0.065]]))
    uv = s.chain.model.project(head.inverse().apply(middle))[:, 0]
    for region, (u, v) in zip(find(s).regions, uv, strict=True):
        assert region.u < u < region.u + region.width
        assert region.v < v < region.v + region.height


def test_one_camera_alone_still_finds_it_with_what_is_known_of_the_ground(at_five_metres):
    s = at_five_metres
    blind = replace(s.data, counts=(np.full_like(s.data.counts[0], 3), s.data.counts[1]))
    found = find(replace(s, data=blind))
    error = found.position_m - s.after.position_m
    assert found.regions[0] is None
    assert error @ np.linalg.solve(found.covariance, error) < 16.0


def test_what_only_one_of_two_seeing_cameras_sees_move_is_not_believed(at_five_metres):
    s = at_five_metres
    left, right = s.data.counts
    still = np.stack([left[1], left[1]])
    assert find(replace(s, data=replace(s.data, counts=(still, right)))) is None


def test_a_rover_at_rest_is_not_found():
    assert all(find(look(5.0, i, step_m=0.0)) is None for i in range(3))


def test_something_else_that_moves_is_not_taken_for_the_rover(at_five_metres):
    s = at_five_metres
    first = [stack[0] for stack in s.data.counts]
    stacks = []
    for frame in first:
        second = frame.copy()
        second[100:103, 200:600] += 200  # a shadow of something thin
        stacks.append(np.stack([frame, second]))
    assert find(replace(s, data=replace(s.data, counts=tuple(stacks)))) is None


def test_frames_of_two_places_show_no_moving_rover():
    s, t = (look(5.0, i) for i in (1, 2))
    height, width = (min(a.counts[c].shape[k] for a in (s.data, t.data) for c in (0, 1)) for k in (1, 2))
    windows = tuple(Window(w.u, w.v, width, height) for w in s.data.windows)
    counts = tuple(
        np.stack([a[0, :height, :width], b[1, :height, :width]])
        for a, b in zip(t.data.counts, s.data.counts, strict=True)
    )
    assert find(replace(s, data=replace(s.data, windows=windows, counts=counts))) is None
