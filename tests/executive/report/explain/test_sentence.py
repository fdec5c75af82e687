"""The sentence over generated histories: it says what came up, what was tried, and the end."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.types import Point, PoseEstimate, Segment
from executive.record import History
from executive.record.events import (
    FaultEvent,
    HypothesesEvent,
    Level,
    LogEvent,
    NodeChange,
    RouteEvent,
    Stop,
    StrategyEvent,
    Verdict,
    WaypointEvent,
)
from executive.record.history import At
from executive.report.explain import sentence

LEAF = "go/recover/sequence/localise"
POSE = PoseEstimate(0.0, (2.0, 0.0, 0.0), (0, 0, 0, 1), [[0.0] * 6] * 6, "markers")
ROUTE = RouteEvent(tuple(Segment(Point(n, 0.0), Point(n + 1, 0.0), 0.03, 0.2, 0.03, n) for n in (2, 3)))
NAMES = st.sampled_from(["back_off", "fresh_look", "wait_for_sight", "detour", "look_again"])
CAUSES = st.sampled_from(["stuck_on_obstacle", "marker_lost", "lost_rover", "tether_snag"])


def told(*events):
    return sentence(History.holding([At(float(time_s), event) for time_s, event in events]))


def failed(time_s, reason="not_seen", detail=""):
    """A leaf failed, and the node above passed it on."""
    return [
        (time_s, NodeChange(LEAF, "failure", reason, detail)),
        (time_s, NodeChange(LEAF.rpartition("/")[0], "failure")),
    ]


def answered(time_s, name, cause, verdict):
    """A strategy was chosen, and what became of it."""
    chosen = (time_s, StrategyEvent(name, cause, 0.75, 1, Verdict.CHOSEN))
    return [chosen, *([(time_s + 5, StrategyEvent(name, cause, 0.75, 1, verdict))] if verdict else [])]


def test_a_run_in_which_nothing_came_up():
    reached = [(n, WaypointEvent(n, Point(n, 0.0), POSE)) for n in range(3)]
    said = told((0, ROUTE), *reached, (60, Stop("reached")))
    assert (
        said
        == "Nothing came up; the goal was reached after 1\u00a0min\u00a000\u00a0s, 3 of 3 way-points reached."
    )


def test_a_fault_its_conclusion_what_was_tried_and_a_good_end():
    story = [
        (5, FaultEvent("led_off", True)),
        *failed(10, detail="no marker"),
        *answered(10, "back_off", "marker_lost", Verdict.FAILED),
        *failed(20, detail="no marker"),
        *answered(20, "look_again", "marker_lost", Verdict.HELPED),
        (30, Stop("reached")),
    ]
    assert told(*story).replace("\u00a0", " ") == (
        "Injected fault led_off took effect; localise failed at 10 s (not seen, no marker), and 1 more "
        "failure after it; marker_lost (weight 0.75) was concluded; back_off did not help; look_again "
        "helped; the goal was reached after 30 s."
    )


def test_a_call_home_after_no_strategy_fitted():
    said = told(*failed(10), (10, LogEvent(Level.WARNING, "pool", "none")), (12, Stop("help", "no_strategy")))
    assert "no strategy fitted; the rover stopped and called home after 12" in said


def test_an_end_that_nobody_asked_the_pool_about_names_the_failure_and_what_leads():
    weighed = (9, HypothesesEvent({"nominal": 0.1, "tilt_risk": 0.9}))
    said = told(*failed(8, "tilt", "31 deg"), weighed, (10, Stop("safe_hold")))
    assert said.startswith("Localise failed at 8")
    assert "(tilt, 31 deg); tilt_risk (weight 0.90) was concluded; the rover was stopped safely" in said


def test_a_record_that_was_cut_off_says_so():
    assert told((3, NodeChange("go", "running"))) == "Nothing came up; the record breaks off after 3\u00a0s."


def test_up_to_a_moment_nothing_later_is_told():
    history = History.holding([At(5.0, FaultEvent("cloud", True)), At(9.0, Stop("error", "boom"))])
    assert sentence(history, 4.0) == "Nothing came up; the run was under way after 4\u00a0s."
    assert sentence(history).endswith("a defect ended the run after 9\u00a0s: boom.")


STEPS = st.lists(
    st.tuples(NAMES, CAUSES, st.sampled_from([None, Verdict.HELPED, Verdict.FAILED])), max_size=8
)


@settings(max_examples=200, deadline=None)
@given(
    faults=st.sets(st.sampled_from(["led_off", "cloud", "rock_on_path", "pan_locked", "track_jam"])),
    steps=STEPS,
    refused=st.booleans(),
    outcome=st.sampled_from(
        [None, "reached", "help", "safe_hold", "time_limit", "invalid", "error", "strange"]
    ),
)
def test_every_history_becomes_one_short_sentence_that_keeps_to_the_record(faults, steps, refused, outcome):
    events = [(1, FaultEvent(name, True)) for name in sorted(faults)]
    for n, (name, cause, verdict) in enumerate(steps):
        events += [*failed(10 * n + 10), *answered(10 * n + 10, name, cause, verdict)]
    if refused:
        events.append((95, LogEvent(Level.WARNING, "pool", "none fits")))
    events.append((100, NodeChange("go", "failure")))
    if outcome is not None:
        events.append((100, Stop(outcome)))
    said = told(*events)
    assert said[0].isupper()
    assert said.count(". ") == 0
    assert said.endswith(".")
    assert len(said) < 500
    nothing = not faults and not steps and not refused
    assert said.startswith(("Nothing came up", "No failure was recorded")) == nothing
    assert (" helped" in said) == any(verdict is Verdict.HELPED for _, _, verdict in steps)
    assert ("no strategy fitted" in said.lower()) == refused
    assert ("the goal was reached" in said) == (outcome == "reached")
    if len({name for name, _, _ in steps}) == 1:
        assert steps[0][0] in said


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
def test_however_many_faults_at_most_three_are_listed(count):
    said = told(*((1, FaultEvent(f"fault_{n}", True)) for n in range(count)), (2, Stop("reached")))
    assert said.count("fault_") == (count if count <= 3 else 2)
    assert (f"and {count - 2} more" in said) == (count > 3)
