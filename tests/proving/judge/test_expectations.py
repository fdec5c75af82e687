"""Expectations and safety of small made-up runs: truth, telemetry and weights are given second by second."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.core.rig import RigCalibration
from executive.core.types import Point, Segment
from executive.record import (
    History,
    Recorder,
    TruthRecorder,
    summarise,
)
from executive.record.events import (
    FaultEvent,
    HypothesesEvent,
    RouteEvent,
    SegmentEvent,
    Start,
    Stop,
    StrategyEvent,
    Telemetry,
    TruthEvent,
    Verdict,
)
from executive.record.rows import JudgedRow, first_violated, row, worst_first
from executive.run.judging import exit_code
from proving.judge.expect import Expect
from proving.judge.expectations import judge
from proving.judge.instrument import met as as_it_should_be
from proving.judge.safety import safety_rows

SEGMENT = Segment(Point(0.0, 0.0), Point(1.0, 0.0), 0.03, 0.10, 0.02, 0)


def reported(moving=False, roll_deg=0.0) -> Telemetry:
    return Telemetry(0, 0, 0, 0, math.radians(roll_deg), 0, 0, 0, 0, 0, 0, 0, moving)


def true(x=0.0, y=0.0, roll_deg=0.0, tether_n=0.0) -> TruthEvent:
    quat = tuple(float(q) for q in Rotation.from_euler("x", roll_deg, degrees=True).as_quat())
    return TruthEvent((x, y, 0.0), quat, tether_n=tether_n)


def weights(**of) -> HypothesesEvent:
    return HypothesesEvent({"nominal": 1 - sum(of.values()), **of})


class Story:
    """A run put down as {time [s]: event or events}, read back as the judges see it."""

    def __init__(self, folder: Path, events, truth=None, outcome="reached", end_s=20.0):
        record, world = folder / "record.mcap", folder / "truth.mcap"
        with Recorder(record) as recorder:
            recorder.write(Start("s", "", 3, 1.0), 0.0)
            recorder.write(RouteEvent((SEGMENT,)), 0.0)
            recorder.write(SegmentEvent(SEGMENT), 0.0)
            for time_s, told in sorted(events.items()):
                for event in told if isinstance(told, list) else [told]:
                    recorder.write(event, time_s)
            if outcome is not None:
                recorder.write(Stop(outcome), end_s)
        if truth is not None:
            with TruthRecorder(world) as recorder:
                for time_s, event in sorted(truth.items()):
                    recorder(event, time_s)
        self.history = History.of(record)
        self.world = History.of(world) if truth is not None else History.empty()
        self.result = summarise(record, world)

    def judged(self, **expect):
        """The rows of these expectations, as `expect` of a file has them."""
        model = Expect.model_validate(expect, strict=False)
        return judge(model, self.result, self.history, self.world)

    def safety(self):
        return safety_rows(self.history, self.world, RigCalibration())


@pytest.fixture
def story(tmp_path):
    """Leans and strays at 6 s, is off the track at 8 s, pulls its tether at 9 s; a fault from 10 to 15 s."""
    truth = {float(t): true(0.01 * t) for t in range(21)}
    truth |= {6.0: true(0.06, 0.04, 26.0), 8.0: true(0.08, 0.12), 9.0: true(0.09, 0.0, 0.0, 3.0)}
    truth[20.0] = truth[19.0]
    events = {float(t): [reported(t < 19, t)] for t in range(21)}
    events[10.0].append(FaultEvent("led_off", True, "marker_lost"))
    events[11.0].append(weights(overshoot=0.8))
    events[13.0].append(weights(marker_lost=0.9))
    events[14.0].append(StrategyEvent("back_off", "marker_lost", 0.9, 1, Verdict.CHOSEN))
    events[15.0].append(FaultEvent("led_off", False))
    events[17.0].append(weights())
    return Story(tmp_path, events, truth)


@pytest.mark.parametrize(
    ("expect", "met", "robustness", "violated_s"),
    [
        ({"outcome": ["reached", "help"]}, True, None, None),
        ({"outcome": ["help"]}, False, None, 20.0),
        ({"final_error": {"below": "900 mm"}}, True, 0.09, None),
        ({"final_error": {"below": "800 mm"}}, False, -0.01, 20.0),
        ({"max_cross_track": {"below": "130 mm"}}, True, 0.01, None),
        ({"max_cross_track": {"below": "40 mm"}}, False, -0.08, 6.0),
        ({"driven_beyond_off_track": {"below": "1 mm"}}, False, 0.001 - math.hypot(0.01, 0.12), 8.0),
        ({"max_tilt": {"below": "30 deg"}}, True, 4.0, None),
        ({"max_tilt": {"below": "25 deg"}}, False, -1.0, 6.0),
        ({"max_tether": {"below": "2 N"}}, False, -1.0, 9.0),
        ({"at_rest": True}, True, 1e-4, None),
        ({"waypoints_reached": {"at_least": 1}}, False, -1, 20.0),
        ({"detected": [{"fault": "led_off"}]}, True, None, None),
        ({"detected": [{"fault": "led_off", "within": "2 s"}]}, True, 1.0, None),
        ({"diagnosed": [{"fault": "led_off", "as": "marker_lost", "within": "4 s"}]}, True, 1.0, None),
        ({"diagnosed": [{"fault": "led_off", "as": "marker_lost", "within": "2 s"}]}, False, -1.0, 12.0),
        ({"diagnosed": [{"fault": "led_off", "as": "overshoot"}]}, True, None, None),
        ({"diagnosed": [{"fault": "led_off", "as": "tilt_risk"}]}, False, None, 20.0),
        ({"recovered": [{"fault": "led_off", "within": "9 s"}]}, True, 2.0, None),
        ({"recovered": [{"fault": "led_off", "within": "5 s"}]}, False, -2.0, 15.0),
        ({"strategies_tried": ["back_off"]}, True, None, None),
        ({"strategies_not_tried": ["back_off"]}, False, None, 14.0),
        ({"always": ["tilt < 25 deg"]}, True, math.radians(5), None),
        ({"always": ["tilt < 11.5 deg"]}, False, math.radians(-8.5), 12.0),
        ({"eventually": ["true_tether_tension > 2 N"]}, True, 1.0, None),
        ({"until": ["moving until[0 s, 15 s] tilt > 10 deg"]}, True, math.radians(5), None),
        ({"holds": ["always[0 s, 5 s] true_tilt < 1 deg"]}, True, math.radians(1), None),
    ],
)
def test_an_expectation_is_met_or_not_by_so_much_and_since_then(story, expect, met, robustness, violated_s):
    (found,) = story.judged(**expect)
    assert (found.met, found.t_violation_s) == (met, violated_s)
    assert found.robustness == (None if robustness is None else pytest.approx(robustness))


def test_what_failed_first_comes_first(story):
    rows = story.judged(
        outcome=["help"],
        always=["tilt < 11.5 deg"],
        max_tilt={"below": "25 deg"},
        max_tether={"below": "9 N"},
    )
    assert first_violated(rows).text == "max_tilt below 25 deg"
    assert [r.t_violation_s for r in worst_first(rows)] == [6.0, 12.0, 20.0, None]


def test_a_fault_that_never_took_effect_meets_nothing(story):
    (found,) = story.judged(detected=[{"fault": "other"}])
    assert (found.met, found.warning) == (False, "other never took effect")


def test_safety_names_what_broke_and_when(tmp_path, story):
    beyond, tilt, tether, rest = story.safety()
    assert (beyond.met, beyond.t_violation_s) == (False, 8.0)
    assert (tilt.met, tilt.robustness) == (True, pytest.approx(4.0))
    assert (tether.met, tether.robustness) == (True, pytest.approx(7.0))
    assert rest.met is True


@pytest.mark.parametrize(
    ("last", "moving", "rests"),
    [((0.19, 0.0), False, True), ((0.19, 0.0005), False, False), ((0.19, 0.0), True, False)],
)
def test_at_rest_is_what_truth_and_tracks_both_say(tmp_path, last, moving, rests):
    truth = {19.0: true(0.19), 20.0: true(*last)}
    assert Story(tmp_path, {20.0: reported(moving)}, truth).safety()[3].met is rests


def test_a_rover_seen_at_rest_before_the_end_rests(tmp_path):
    """At rest the truth is sampled now and then only."""
    truth = {3.0: true(0.1), 4.0: true(0.2), 5.0: true(0.2)}
    assert Story(tmp_path, {20.0: reported()}, truth).safety()[3].met is True


def test_of_a_record_that_breaks_off_nobody_knows_whether_it_ended_at_rest(tmp_path):
    rest = Story(tmp_path, {20.0: reported(True)}, {20.0: true(0.2)}, outcome=None).safety()[3]
    assert (rest.met, rest.warning) == (None, "the record ends without a stop")


def test_without_truth_safety_is_not_known_but_expectations_are_not_met(tmp_path):
    run = Story(tmp_path, {0.0: reported(), 20.0: reported()})
    assert [r.met for r in run.safety()] == [None, None, None, True]
    rows = run.judged(
        max_tilt={"below": "9 deg"}, final_error={"below": "9 m"}, always=["true_tilt < 9 deg"], at_rest=True
    )
    assert {r.text: (r.met, r.warning) for r in rows} == {
        "final_error below 9000 mm": (False, "no truth was recorded"),
        "at rest at the end": (True, None),
        "max_tilt below 9 deg": (False, "no truth was recorded"),
        "always (true_tilt < 9 deg)": (False, "no samples of true_tilt"),
    }


def test_a_row_says_nothing_that_json_cannot(tmp_path):
    assert row("x", True, math.inf, "m").robustness is None
    assert row("x", False, float(np.nan), "m", 3.0) == JudgedRow("x", False, t_violation_s=3.0)


@pytest.mark.parametrize(
    ("outcome", "expected", "met", "safe", "code"),
    [
        ("reached", (), (), True, 0),
        ("help", (), (), True, 1),
        ("help", ("help",), (True,), True, 0),
        ("help", ("help",), (True, False), True, 1),
        ("reached", ("reached",), (True,), False, 1),
        ("reached", ("reached",), (True,), None, 0),
        ("invalid", ("reached",), (True,), True, 1),
        ("error", (), (), True, 3),
        ("error", ("reached",), (False,), True, 3),
        ("error", ("error",), (True,), True, 0),
        ("error", ("error",), (True,), False, 3),
        ("error", ("error",), (True, False), True, 3),
    ],
)
def test_the_exit_code_stands_for_expectations_and_safety(outcome, expected, met, safe, code):
    rows = [row("as expected", each) for each in met]
    found = as_it_should_be(Expect(outcome=expected), outcome, rows, [row("safe", safe)])
    assert exit_code(outcome, found) == code


def test_mission_time_and_path_lie_between_their_bounds(story):
    rows = story.judged(mission_time={"above": "10 s", "below": "30 s"}, path={"below": "1 mm"})
    assert [row.met for row in rows] == [True, False]
    assert rows[0].text == "mission_time above 10 s and below 30 s"
    assert rows[0].robustness == pytest.approx(10.0)


def test_what_has_no_bound_is_refused_since_it_would_always_hold():
    with pytest.raises(ValueError, match="got no bound, expected above, below or both"):
        Expect.model_validate({"path": {}})
    with pytest.raises(ValueError, match="got no bound, expected at_least, at_most or both"):
        Expect.model_validate({"times": [{"of": {"localise": "success"}}]}, strict=False)


def test_an_end_that_no_node_has_is_refused_with_a_guess():
    with pytest.raises(ValueError, match=r'got "succes", expected success.*did you mean "success"'):
        Expect.model_validate({"never": [{"localise": "succes"}]}, strict=False)
