import math

import numpy as np
import pytest

from proving.campaign_report.statistics import Estimate, Pairs, median, share


def test_a_share_of_nothing_is_not_a_number():
    found = share(0, 0)
    assert math.isnan(found.value)


@pytest.mark.parametrize(
    ("hits", "total", "low", "high"),
    [
        (0, 10, 0.0, 0.2775),
        (10, 10, 0.7225, 1.0),
        (81, 263, 0.2553, 0.3662),
    ],  # the last is Newcombe's example
)
def test_wilson_intervals_are_those_of_the_literature(hits, total, low, high):
    found = share(hits, total)
    assert (found.low, found.high) == pytest.approx((low, high), abs=1e-4)


def test_mcnemar_is_the_exact_binomial_on_pairs_that_disagree():
    assert Pairs(40, 1, 9, 5).p_value() == pytest.approx(2 * 11 / 1024)
    assert Pairs(40, 0, 0, 5).p_value() == 1.0


def test_the_difference_changes_sign_with_the_order():
    one = Pairs(30, 9, 2, 7).difference()
    other = Pairs(30, 2, 9, 7).difference()
    assert (other.value, other.low, other.high) == pytest.approx((-one.value, -one.high, -one.low))
    assert one.value == pytest.approx(-7 / 48)
    assert one.low < one.value < one.high


def test_pairs_that_never_disagree_still_leave_room_for_a_difference():
    found = Pairs(47, 0, 0, 6).difference()
    assert found.value == 0.0
    assert -found.low == pytest.approx(found.high)
    assert found.high > 0.01


def test_the_interval_of_the_difference_covers_the_truth_as_often_as_it_says():
    rng = np.random.default_rng(3)
    shares = np.array([0.70, 0.05, 0.15, 0.10])
    draws = rng.multinomial(60, shares, size=600)
    found = [Pairs(*(int(n) for n in draw)).difference() for draw in draws]
    covered = np.mean([e.low <= 0.10 <= e.high for e in found])
    assert 0.93 <= covered <= 0.98


def test_the_bootstrap_of_the_median_is_the_same_every_time_and_covers():
    rng = np.random.default_rng(4)
    covered = []
    for n in range(60):
        found = median(list(rng.normal(0.01, 0.02, 40)), np.random.default_rng(n))
        covered.append(found.low <= 0.01 <= found.high)
    assert np.mean(covered) >= 0.88
    data = list(rng.normal(size=20))
    assert median(data, np.random.default_rng(1)) == median(data, np.random.default_rng(1))


def test_the_median_of_equal_values_has_no_width():
    assert median([0.2, 0.2, 0.2], np.random.default_rng(0)) == Estimate(0.2, 0.2, 0.2)
