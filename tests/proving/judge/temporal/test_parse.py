import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.chance import generator
from executive.tree.expressions.typed import GuardError
from proving.judge.temporal import names, parse_formula
from proving.judge.temporal.formula import (
    Always,
    And,
    Bounds,
    Eventually,
    Implies,
    Not,
    Or,
    Until,
)
from tests.proving.judge.temporal.random_formulas import TYPES, formula

WORDS = ["always", "eventually", "until", "not", "and", "or", "implies", "->", "(", ")", "[0 s, 1 s]"]
WORDS += ["x", "y", "<", ">", "0", "1", "min", ",", "s"]


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("x > 0 and y > 0 or x < 0", "((x > 0) and (y > 0)) or (x < 0)"),
        ("x > 0 or y > 0 and x < 0", "(x > 0) or ((y > 0) and (x < 0))"),
        ("x > 0 -> y > 0 -> x < 0", "(x > 0) implies ((y > 0) implies (x < 0))"),
        ("x > 0 until y > 0 until x < 0", "(x > 0) until ((y > 0) until (x < 0))"),
        ("x > 0 and y > 0 until x < 0", "(x > 0) and ((y > 0) until (x < 0))"),
        ("always[0 s, 5 s] x > 0 and y > 0", "(always[0 s, 5 s] (x > 0)) and (y > 0)"),
        ("always not eventually x > 0 until y > 0", "(always (not (eventually (x > 0)))) until (y > 0)"),
        ("not x > 0 implies y > 0", "(not (x > 0)) implies (y > 0)"),
        ("(x + y) * 2 > 0 and ((x)) < 1", "((x + y) * 2 > 0) and (((x)) < 1)"),
    ],
)
def test_operators_bind_as_the_manual_says(text, same):
    assert _shape(parse_formula(text, TYPES)) == _shape(parse_formula(same, TYPES))


def _shape(parsed):
    match parsed:
        case Not(inner=inner) | Always(inner=inner) | Eventually(inner=inner):
            return type(parsed), getattr(parsed, "bounds", None), _shape(inner)
        case And() | Or() | Implies() | Until():
            return type(parsed), getattr(parsed, "bounds", None), _shape(parsed.left), _shape(parsed.right)
    return parsed.text


def _written(parsed):
    """The formula as text again, every pair of parentheses there."""
    bounds = getattr(parsed, "bounds", Bounds())
    within = "" if bounds == Bounds() else f"[{bounds.first_ns} ns, {bounds.last_ns} ns]"
    match parsed:
        case Not(inner=inner) | Always(inner=inner) | Eventually(inner=inner):
            return f"{type(parsed).__name__.lower()}{within} ({_written(inner)})"
        case And() | Or() | Implies() | Until():
            word = type(parsed).__name__.lower()
            return f"({_written(parsed.left)}) {word}{within} ({_written(parsed.right)})"
    return parsed.text


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 4))
def test_what_is_written_out_reads_back_the_same(seed, depth):
    parsed = parse_formula(formula(generator(seed, "round trip"), depth).ours, TYPES)
    assert _shape(parse_formula(_written(parsed), TYPES)) == _shape(parsed)


@pytest.mark.parametrize(
    ("text", "bounds"),
    [
        ("always[5 s, 2 min] tilt < 5 deg", Bounds(5 * 10**9, 120 * 10**9)),
        ("always[100 ms, inf] tilt < 5 deg", Bounds(10**8, None)),
        ("eventually abs(cross_track) <= 250 mm", Bounds(0, None)),
        ("moving until[0 s, 1 h] waypoint == 3", Bounds(0, 3600 * 10**9)),
    ],
)
def test_bounds_are_durations_with_units(text, bounds):
    assert parse_formula(text).bounds == bounds


def test_a_formula_knows_its_signals_and_its_parts_their_text():
    parsed = parse_formula("always (moving implies abs(cross_track) + 1 cm < 250 mm)")
    assert names(parsed) == ("moving", "cross_track")
    assert parsed.inner.text == "moving implies abs(cross_track) + 1 cm < 250 mm"
    assert parsed.inner.right.text == "abs(cross_track) + 1 cm < 250 mm"


@pytest.mark.parametrize(
    ("text", "offset", "message"),
    [
        ("always tilt < 5 mm", 14, "got a length, expected an angle to compare with '<'"),
        ("always tlt < 5 deg", 7, "got 'tlt', expected a number, a signal or (...); did you mean \"tilt\"?"),
        ("always tilt", 7, "got an angle, expected something true or false"),
        ("always[5, 9 s] moving", 7, "got 5 without a unit, expected a duration such as '36 s'"),
        ("always[5 m, 9 s] moving", 7, "got a length, expected a duration such as '36 s'"),
        ("always[9 s, 5 s] moving", 6, "got [9 s, 5 s], expected the earlier bound first"),
        ("always[9 s] moving", 10, "got ']', expected ','"),
        ("always[soon, 5 s] moving", 7, "got 'soon', expected a duration such as '36 s'"),
        ("moving until", 12, "got 'the end', expected a number, a signal or (...)"),
        ("(moving and tilt < 1 deg", 24, "got 'the end', expected ')'"),
        ("moving (tilt < 1 deg)", 7, "got '(', expected the end or an operator"),
        ("x + y < 3", 8, "got a plain number, expected a length to compare with '<'"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(text, offset, message):
    with pytest.raises(GuardError) as caught:
        parse_formula(text)
    assert (caught.value.offset, caught.value.message) == (offset, message)


@settings(max_examples=300, deadline=None)
@given(
    st.text(alphabet="xy()[]<>=-+*/, 01s.", max_size=30)
    | st.lists(
        st.sampled_from(WORDS),
        max_size=14,
    ).map(" ".join)
)
def test_any_text_is_a_formula_or_an_error_inside_it(text):
    try:
        parse_formula(text, TYPES)
    except GuardError as error:
        assert 0 <= error.offset <= len(text)


@pytest.mark.parametrize(
    "text", ["(" * 200 + "x > 0" + ")" * 200, "not " * 200 + "x > 0", "x > 0 -> " * 200 + "x > 0"]
)
def test_nesting_has_a_limit(text):
    with pytest.raises(GuardError, match="nested deeper"):
        parse_formula(text, TYPES)
