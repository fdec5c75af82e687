"""Values left to chance in files."""

import numpy as np
import pytest

from executive.config.distributions import draw, drawn
from executive.config.source import read_text
from executive.core.errors import ConfigError
from executive.core.units import LENGTH, quantity


def rng_of(place):
    return np.random.default_rng([len(place), sum(place.encode())])


def draws(data, n=2000):
    rng = np.random.default_rng(5)
    return [draw(data, rng) for _ in range(n)]


def test_quantities_keep_their_unit_and_their_limits():
    values = draws({"uniform": ["10 mm", "0.03 m"]})
    lengths = [quantity(value, LENGTH) for value in values]
    assert all(value.endswith(" mm") for value in values)
    assert 0.010 <= min(lengths) < 0.0105
    assert 0.0295 < max(lengths) <= 0.030


def test_a_normal_has_its_mean_and_spread():
    values = draws({"normal": [3.0, 0.5]})
    assert np.mean(values) == pytest.approx(3.0, abs=0.05)
    assert np.std(values) == pytest.approx(0.5, rel=0.1)


def test_whole_numbers_include_both_ends():
    assert set(draws({"integer": [2, 4]})) == {2, 3, 4}


def test_a_choice_may_be_of_anything():
    assert {str(v) for v in draws({"choice": [1, "crust", {"like": "crust"}]})} == {
        "1",
        "crust",
        "{'like': 'crust'}",
    }


def test_half_of_a_log_uniform_lies_below_the_geometric_mean():
    values = np.array(draws({"log_uniform": [1.0, 100.0]}))
    assert np.mean(values < 10.0) == pytest.approx(0.5, abs=0.05)


def test_each_place_draws_its_own_and_the_same_every_time():
    source = read_text("world: {a: {uniform: [0, 1]}, bb: {uniform: [0, 1]}, c: 3}", "f.yaml")
    once, again = (drawn(source, ("world",), rng_of).data["world"] for _ in range(2))
    assert once == again
    assert once["a"] != once["bb"]
    assert once["c"] == 3


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("a: {uniform: [1 m]}", "f.yaml:1:4: got a list of 1, expected two values"),
        ("a: {uniform: [1 m, 2 s]}", "f.yaml:1:4: got a list of 2, expected two values of one dimension"),
        ("a: {uniform: [2, 1]}", "f.yaml:1:4: got limits 2 and 1, expected first <= second"),
        ("a: {integer: [1.5, 3]}", "f.yaml:1:4: got a list of 2, expected two whole numbers"),
        ("a: {choice: 3}", "f.yaml:1:4: got 3, expected a list"),
        ("a: {log_uniform: [0, 3]}", "f.yaml:1:4: got limits 0 and 3, expected 0 < first"),
        ("a: {normal: [0, -3]}", "f.yaml:1:4: got a standard deviation of -3"),
        ("a: {uniform: [1 m, xx]}", "f.yaml:1:4: got 'xx', expected a number with its unit"),
    ],
)
def test_a_distribution_that_makes_no_sense_is_refused_in_its_place(text, problem):
    with pytest.raises(ConfigError) as refused:
        drawn(read_text(text, "f.yaml"), (), rng_of)
    assert str(refused.value).startswith(problem)
