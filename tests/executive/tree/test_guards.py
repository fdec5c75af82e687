import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.values import INTEGER, LENGTH, QUALITY
from executive.tree.expressions.guards import UndecidedError, parse_guard
from executive.tree.expressions.typed import GuardError

TYPES = {"a": LENGTH, "b": LENGTH, "n": INTEGER, "q": QUALITY}


def holds(text, **values):
    guard = parse_guard(text)
    guard.check(TYPES)
    return guard.holds(lambda name, attributes: values.get(name))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{a} < 30 mm", True),
        ("0 m < {a} <= 20 mm", True),
        ("0 m < {a} < 10 mm", False),
        ("abs(-{a}) == 2 cm", True),
        ("min({a}, {b}) == {a} and max({a}, {b}) == {b}", True),
        ("not {a} > {b} or false", True),
        ("{n} / 2 == 1.5", True),
        ("{a} * {b} < {b} * {b}", True),
        ("{a} / {b} < 10 %", False),
        ("{q} == 'precise'", True),
        ("2 + 3 * 4 == 14 and (2 + 3) * 4 == 20", True),
        ("{a} - {b} < 0 m", True),
    ],
)
def test_expressions_mean_what_they_say(text, expected):
    assert holds(text, a=0.02, b=0.1, n=3, q="precise") is expected


def test_what_is_unset_or_not_a_number_makes_it_unknown():
    assert holds("{a} < 1 m", a=None) is None
    assert holds("{a} < 1 m", a=math.nan) is None
    assert holds("{a} / {b} < 1", a=1.0, b=0.0) is None
    assert holds("{a} / {b} < 1", a=1.0, b=np.float64(0.0)) is None
    assert holds("not {a} - {b} < 1 m", a=math.inf, b=math.inf) is None
    assert holds("false and {a} < 1 m") is False


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("{a} / 0 < 1 m", "a division by zero"),
        ("{a} / (2 - 2) < 1 m", "a division by zero"),
        ("1 / 0 > 0.5", "a division by zero"),
        ("1e999 - 1e999 < 1", "never be decided: one side is not a number"),
    ],
)
def test_what_can_never_be_decided_is_found_when_it_is_read(text, complaint):
    with pytest.raises(GuardError, match=complaint):
        parse_guard(text).check(TYPES)


def test_an_undecided_guard_says_why():
    def broken(name, attributes):
        raise RuntimeError("no reading")

    for read, why in (
        (lambda name, attributes: None, r"\{a\} is not set"),
        (lambda name, attributes: math.nan, r"\{a\} is not a number"),
        (lambda name, attributes: "far", "TypeError"),
        (broken, "RuntimeError: no reading"),
    ):
        with pytest.raises(UndecidedError, match=why):
            parse_guard("{a} < 1 m").decide(read)


NUMBERS = st.one_of(st.none(), st.floats(), st.just(0.0), st.floats().map(np.float64))
TERMS = st.recursive(
    st.sampled_from(["{a}", "{b}", "2 m", "0 m"]),
    lambda inner: (
        st.builds("({} {} {})".format, inner, st.sampled_from("+-"), inner)
        | st.builds("abs({})".format, inner)
        | st.builds("min({}, {})".format, inner, inner)
    ),
    max_leaves=5,
)
COMPARISONS = st.builds("{} {} {}".format, TERMS, st.sampled_from(["<", "<=", ">", ">=", "==", "!="]), TERMS)
QUOTIENTS = st.builds("{} / {} < 1".format, TERMS, TERMS)


@settings(max_examples=300, deadline=None)
@given(text=COMPARISONS | QUOTIENTS, a=NUMBERS, b=NUMBERS)
def test_a_guard_is_decided_exactly_where_each_side_is_a_number(text, a, b):
    guard = parse_guard(text)
    values = {"a": a, "b": b}
    decided = guard.holds(lambda name, attributes: values[name])
    opposite = parse_guard(f"not ({text})").holds(lambda name, attributes: values[name])
    assert (decided, opposite) in {(True, False), (False, True), (None, None)}
    named = [value for name, value in values.items() if f"{{{name}}}" in text]
    if any(value is None or math.isnan(value) for value in named):
        assert decided is None


@settings(max_examples=300, deadline=None)
@given(st.text(alphabet="{}ab.()<>=!+-*/ 013mdegndort'\"%,_\n", max_size=30) | st.text(max_size=12))
def test_any_text_is_a_guard_or_a_guard_error_inside_it(text):
    try:
        guard = parse_guard(text)
        guard.check(TYPES)
    except GuardError as error:
        assert 0 <= error.offset <= len(text)
        return
    assert guard.holds(lambda name, attributes: 1) in (True, False, None)


def test_nesting_has_a_limit():
    with pytest.raises(GuardError, match="nested deeper"):
        parse_guard("(" * 500 + "true" + ")" * 500)
