import numpy as np
import pytest

from executive.core.chance import generator
from executive.core.clock import Stopwatch
from executive.core.values import FLAG, LENGTH, NUMBER
from proving.judge.temporal import judge, on_one_grid, parse_formula
from proving.judge.temporal.semantics import Decisions, Margins, evaluate
from proving.judge.temporal.trace import SignalTrace
from tests.proving.judge.temporal.direct import value
from tests.proving.judge.temporal.random_formulas import TYPES, formula

KINDS = {"x": NUMBER, "y": NUMBER, "far": LENGTH, "moving": FLAG}


def traced(**samples) -> SignalTrace:
    """Each signal as {time [s]: value}."""
    pairs = {name: (np.array(list(told)), np.array(list(told.values()))) for name, told in samples.items()}
    return on_one_grid(pairs, max((max(told) for told in samples.values() if told), default=0.0))


def judged(text, **samples):
    return judge(parse_formula(text, KINDS), traced(**samples))


def irregular(rng) -> SignalTrace:
    """Two signals sampled at their own uneven times, neither from the start."""

    def sampled():
        count = int(rng.integers(1, 14))
        return np.sort(rng.choice(25, size=count, replace=False)) + 1.0, rng.normal(size=count)

    return on_one_grid({"x": sampled(), "y": sampled()}, float(rng.integers(1, 32)))


@pytest.mark.parametrize("batch", range(4))
def test_uneven_sampling_means_what_the_definition_says(batch):
    rng = generator(batch, "uneven")
    for _ in range(60):
        text, trace = formula(rng, 2).ours, irregular(rng)
        parsed = parse_formula(text, TYPES)
        expected = [value(parsed, trace, i) for i in range(trace.count)]
        np.testing.assert_array_equal(evaluate(parsed, trace, Margins(trace)), expected, err_msg=text)


@pytest.mark.parametrize("batch", range(4))
def test_verdict_and_robustness_have_one_sign(batch):
    rng = generator(batch, "signs")
    for _ in range(60):
        text, trace = formula(rng, 3).ours, irregular(rng)
        parsed = parse_formula(text, TYPES)
        margins, decisions = (evaluate(parsed, trace, s(trace)) for s in (Margins, Decisions))
        decided = margins != 0
        np.testing.assert_array_equal(np.sign(margins)[decided], np.sign(decisions)[decided], err_msg=text)


@pytest.mark.parametrize("batch", range(4))
def test_nothing_that_comes_after_a_violation_can_mend_it(batch):
    rng, seen = generator(batch, "cuts"), 0
    for _ in range(60):
        text = formula(rng, 2).ours
        times_s = np.arange(20.0)
        x, y = rng.normal(size=(2, 20))
        parsed = parse_formula(text, TYPES)
        found = judge(parsed, on_one_grid({"x": (times_s, x), "y": (times_s, y)}, 19.0))
        if found.met or found.violated_s is None or found.violated_s >= 19.0:
            continue
        seen += 1
        later = times_s > found.violated_s
        for _ in range(3):  # whatever comes afterwards
            other = np.where(later, rng.normal(size=(2, 20)), (x, y))
            assert not judge(
                parsed, on_one_grid({"x": (times_s, other[0]), "y": (times_s, other[1])}, 19.0)
            ).met, text
    assert seen > 10


def test_a_sample_holds_until_the_next_one():
    assert judged("always[5 s, 9 s] x > 0", x={0: 1.0, 10: -1.0}).met
    assert not judged("always[5 s, 10 s] x > 0", x={0: 1.0, 10: -1.0}).met
    assert judged("eventually[11 s, 12 s] x < 0", x={0: 1.0, 10: -1.0, 20: 1.0}).met


def test_until_needs_its_left_side_up_to_the_moment_of_the_right():
    assert judged("x > 0 until y > 0", x={0: 1.0, 5: -1.0}, y={0: -1.0, 5: 1.0}).met
    assert not judged("x > 0 until y > 0", x={0: 1.0, 4: -1.0}, y={0: -1.0, 5: 1.0}).met
    late = judged("x > 0 until[0 s, 4 s] y > 0", x={0: 1.0}, y={0: -1.0, 5: 1.0})
    assert (late.met, late.violated_s) == (False, 4.0)


def test_a_window_that_opens_within_a_sample_asks_for_its_left_side():
    samples = {"x": {0: 1.0, 3: -2.0, 6: 1.0}, "y": {0: -1.0, 3: 5.0, 6: -1.0}}
    assert not judged("x > 0 until[4 s, 5 s] y > 0", **samples).met
    assert judged("x > 0 until[3 s, 5 s] y > 0", **samples).met


def test_robustness_is_the_deciding_margin_in_its_own_unit():
    found = judged("always (far < 30 mm and x > 2)", far={0: 0.01, 4: 0.025}, x={0: 3.0})
    assert (found.robustness, found.unit) == (pytest.approx(0.005), "m")
    found = judged("always (far < 30 mm and x > 2)", far={0: 0.01}, x={0: 3.0, 4: 1.5})
    assert (found.robustness, found.unit, found.violated_s) == (-0.5, "", 4.0)


def test_a_flag_decides_but_has_no_margin():
    found = judged("always (moving implies x < 2)", moving={0: True, 3: False}, x={0: 1.5, 4: 7.0})
    assert (found.met, found.robustness) == (True, 0.5)
    found = judged("eventually moving", moving={0: False, 9: False})
    assert (found.met, found.robustness, found.violated_s) == (False, None, 9.0)


@pytest.mark.parametrize(
    ("text", "met"),
    [("x < 2", False), ("x <= 2", True), ("x == 2", True), ("x != 2", False), ("x >= 2", True)],
)
def test_at_the_limit_itself_the_sign_of_comparison_decides(text, met):
    found = judged(f"always {text}", x={0: 2.0})
    assert (found.met, abs(found.robustness)) == (met, 0.0)


@pytest.mark.parametrize(
    ("text", "violated_s"),
    [
        ("always x > 0", 4.0),
        ("always[0 s, 3 s] x > 0", None),
        ("eventually[0 s, 3 s] x < 0", 3.0),
        ("eventually x < -5", 9.0),
        ("not eventually x < 0", 4.0),
        ("always (x < 0 implies eventually[0 s, 2 s] y > 0)", 6.0),
        ("eventually[0 s, 2 s] always[0 s, 3 s] x < 0", 2.0),
        ("y < 0 until x < -5", 7.0),
    ],
)
def test_a_violation_has_the_time_at_which_it_is_certain(text, violated_s):
    assert judged(text, x={0: 1.0, 4: -1.0, 9: -1.0}, y={0: -1.0, 7: 1.0}).violated_s == violated_s


def test_before_its_first_sample_a_signal_is_left_out():
    assert judged("always x < 2", x={5: 1.0}, y={0: 0.0}).met
    found = judged("x < 2", x={5: 1.0})
    assert (found.met, found.robustness) == (False, None)
    assert found.warning == "unknown at the start: x had no sample yet; put always or eventually before it"


def test_what_has_no_samples_at_all_is_not_met_and_says_so():
    found = judged("always (x < 2 or y < 2)", x={0: 1.0}, y={})
    assert (found.met, found.warning) == (False, "no samples of y")


def test_arithmetic_without_a_result_is_unknown():
    assert judged("always x / y < 2", x={0: 1.0}, y={0: 0.0, 5: 1.0}).met
    assert (
        judged("always x / y < 2", x={0: 1.0}, y={0: 0.0}).warning == "unknown: its arithmetic has no result"
    )


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("always (x > 9 implies y < 0)", "vacuous: 'x > 9' never held"),
        ("always[0 s, 3 s] (x < 0 implies y > 0)", "vacuous: 'x < 0' never held"),
        ("always (x < 0 implies (y > 9 implies x > 3))", "vacuous: 'y > 9' never held"),
        ("always[1 h, 2 h] x > 0", "the run ended before the window of 'always[1 h, 2 h] x > 0' opened"),
        (
            "eventually[1 h, 2 h] x > 0",
            "the run ended before the window of 'eventually[1 h, 2 h] x > 0' opened",
        ),
        ("y > 0 until x > 0", "vacuous: 'x > 0' held from the first, 'y > 0' was never asked for"),
        ("always (x < 0 implies y < 9)", None),
        ("x > 0 until x < 0", None),
    ],
)
def test_what_was_never_put_to_the_test_is_warned_of(text, warning):
    assert judged(text, x={0: 1.0, 4: -1.0}, y={0: -1.0, 7: 1.0}).warning == warning


def test_of_samples_at_one_time_the_last_counts():
    trace = on_one_grid({"x": (np.array([0.0, 1.0, 1.0]), np.array([1.0, -1.0, 2.0]))}, 1.0)
    assert judge(parse_formula("always x > 0", KINDS), trace).met


@pytest.mark.parametrize("window_s", [100, 5000])
def test_a_timed_until_over_50000_samples_takes_under_a_second(window_s):
    times_s, (x, y) = np.arange(50_000.0), generator(1, "long").normal(size=(2, 50_000))
    trace = on_one_grid({"x": (times_s, x), "y": (times_s, y)}, times_s[-1])
    parsed = parse_formula(f"always (x > -9 until[0 s, {window_s} s] y > 2)", TYPES)
    watch = Stopwatch()
    judge(parsed, trace)
    assert watch.elapsed_s() < 1.0
