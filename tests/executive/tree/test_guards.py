import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.values import INTEGER, LENGTH, QUALITY
from executive.tree.expressions.guards import parse_guard
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
    assert holds("{a} / 0 < 1 m", a=1.0) is None
    assert holds("false and {a} < 1 m") is False


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
