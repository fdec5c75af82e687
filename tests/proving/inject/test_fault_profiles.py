"""How strong a fault is over time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proving.inject.profiles import Profile, Shape


def shape(seed=0, **profile):
    return Shape(Profile.model_validate(profile) if profile else None, np.random.default_rng(seed))


def test_a_step_is_there_at_once():
    assert shape().level(0.0) == 1.0


def test_a_ramp_grows_evenly_and_stays():
    ramp = shape(ramp="100 s")
    assert [ramp.level(t) for t in (0.0, 25.0, 100.0, 1e6)] == [0.0, 0.25, 1.0, 1.0]


def test_an_intermittent_fault_is_on_for_its_duty():
    blink = shape(intermittent={"period": "10 s", "duty": "30 %"})
    assert [blink.level(float(t)) for t in range(12)] == [1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1]


def test_random_arrivals_come_as_often_as_they_should():
    arrivals = shape(seed=3, random={"every": "100 s", "lasts": "1 s"})
    levels = [arrivals.level(float(t)) for t in range(100_000)]
    assert sum(levels) == pytest.approx(1000, abs=4 * 1000**0.5)  # a Poisson count, four sigma


def test_equal_seeds_make_equal_arrivals():
    first, again, other = (shape(seed, random={"every": "20 s", "lasts": "5 s"}) for seed in (1, 1, 2))
    times = [float(t) for t in range(500)]
    levels = [first.level(t) for t in times]
    assert levels == [again.level(t) for t in times]
    assert levels != [other.level(t) for t in times]


@given(st.floats(0, 1e5), st.sampled_from([{"ramp": "7 s"}, {"random": {"every": "9 s", "lasts": "2 s"}}]))
def test_a_level_is_a_share(since_s, profile):
    assert 0.0 <= shape(**profile).level(since_s) <= 1.0
