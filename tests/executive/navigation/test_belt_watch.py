"""The watch over belts under way."""

import pytest

from executive.core.types import TrackReading
from executive.navigation.belt_watch import BeltWatch
from executive.navigation.guidance import Belts


def first_problem(belts, counted, until_s=400):
    """The first problem of a drive, and when: `counted(t)` is what the encoders have said after t seconds."""
    watch = BeltWatch(belts, 0.001, TrackReading(100.0, 5.0, 7.0, 0.1, 0.1, moving=True))
    for t in range(until_s):
        left_m, right_m = counted(t)
        now = TrackReading(100.0 + t, 5.0 + left_m, 7.0 + right_m, 0.1, 0.1, moving=True)
        if problem := watch.problem(now):
            return t, problem
    return None


def straight(t, share=1.0):
    return min(share * t * 1e-3, 0.1)


def test_a_drive_as_planned_has_no_problem():
    assert first_problem(Belts(0.1, 0.1), lambda t: (straight(t), straight(t)), until_s=110) is None


@pytest.mark.parametrize("sign", [1, -1])
def test_turning_and_backing_have_none_either(sign):
    belts = Belts(-0.1 * sign, 0.05 * sign)

    def counted(t):
        return -sign * straight(t), sign * straight(t) / 2

    assert first_problem(belts, counted, until_s=110) is None


def test_a_belt_that_counts_nothing_is_found_at_once():
    assert first_problem(Belts(0.1, 0.1), lambda t: (0.0, straight(t))) == (
        10,
        "the left belt counted 0 of 10 mm",
    )


def test_a_belt_that_ceases_to_count_is_found_soon():
    t, problem = first_problem(Belts(0.1, 0.1), lambda t: (straight(t), min(straight(t), 0.045)))
    assert 50 < t <= 60
    assert problem.startswith("the right belt counted 0 of")


def test_a_belt_that_counts_backwards_is_found():
    assert first_problem(Belts(0.1, 0.1), lambda t: (-straight(t), straight(t)))[0] == 10


def test_a_weak_motor_is_let_catch_up_while_the_other_waits():
    assert first_problem(Belts(0.1, 0.1), lambda t: (straight(t, 0.6), straight(t)), until_s=170) is None


def test_a_drive_that_does_not_end_is_found_in_the_end():
    t, problem = first_problem(Belts(0.1, 0.1), lambda t: (min(straight(t), 0.0995), straight(t)))
    assert (t, problem) == (211, "still driving after 211 s, 100 s were planned")


def test_a_drive_of_nothing_has_no_problem():
    assert first_problem(Belts(0.0, 0.0), lambda t: (0.0, 0.0), until_s=5) is None


@pytest.mark.parametrize(("share", "found"), [(0.24, True), (0.26, False)])
def test_a_belt_that_makes_less_than_a_quarter_of_its_way_is_stalled(share, found):
    """A weak motor makes more; a belt that makes less turns the rover off its way."""
    problem = first_problem(Belts(0.1, 0.1), lambda t: (straight(t, share), straight(t)), until_s=60)
    assert (problem is not None) is found
