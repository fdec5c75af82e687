import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.core.errors import RecordError
from executive.core.types import (
    Point,
    PoseEstimate,
    Segment,
)
from executive.record import (
    RunFigures,
    RunResult,
    TruthRecorder,
    read_result,
    summarise,
    write_result,
)
from executive.record.events import (
    FaultArmedEvent,
    FaultEvent,
    HypothesesEvent,
    NodeChange,
    RouteEvent,
    SegmentEvent,
    Start,
    Stop,
    StrategyEvent,
    TruthEvent,
    Verdict,
    WaypointEvent,
)
from executive.record.recorder import Recorder
from executive.record.run_result import FalseAlarm, FaultStages, Waypoints

LEVEL = (0.0, 0.0, 0.0, 1.0)
SEGMENT = Segment(Point(0.0, 0.0), Point(1.0, 0.0), 0.03, 0.10, 0.02, 0)


def estimate(time_s: float, position, quat=LEVEL, sigma: float = 0.01) -> PoseEstimate:
    return PoseEstimate(time_s, position, quat, np.eye(6) * sigma**2, "markers", markers=4)


def run(tmp_path: Path, truth, events, figures=None):
    """Summarise a run of (time, event) pairs; truth as (time, x, y) or (time, x, y, quaternion)."""
    with Recorder(tmp_path / "record.mcap") as record:
        record.write(Start("s", "", 3, 1.0), 0.0)
        record.write(RouteEvent((SEGMENT,)), 0.0)
        for time_s, event in events:
            record.write(event, time_s)
    with TruthRecorder(tmp_path / "truth.mcap") as recorder:
        for time_s, x, y, *quat in truth:
            recorder(TruthEvent((x, y, 0.0), quat[0] if quat else LEVEL, tether_n=0.1 * time_s), time_s)
    return summarise(tmp_path / "record.mcap", tmp_path / "truth.mcap", figures)


def test_waypoint_error_is_the_true_distance_when_declared(tmp_path):
    reached = WaypointEvent(0, SEGMENT.end, estimate(10, (1.0, 0.0, 0.0)))
    truth = [(t, 0.1 * t, 0.003) for t in range(20)]
    result = run(tmp_path, truth, [(10.0, reached), (19.0, Stop("reached"))])
    assert result.truth.waypoint_errors_m == (pytest.approx(0.003),)
    assert result.truth.final_error_m == pytest.approx(math.hypot(0.9, 0.003))
    assert result.waypoints == Waypoints(total=1, reached=1)
    assert (result.outcome, result.reason, result.mission_s) == ("reached", None, 19.0)


def test_way_beyond_the_margin_counts_only_beyond_it(tmp_path):
    # 0.00, 0.04, 0.08, 0.12, 0.16, 0.12, 0.08 m left of the segment
    ys = [0.0, 0.04, 0.08, 0.12, 0.16, 0.12, 0.08]
    truth = [(t, 0.0, y) for t, y in enumerate(ys)]
    result = run(tmp_path, truth, [(0.0, SegmentEvent(SEGMENT))])
    assert result.truth.driven_beyond_off_track_m == pytest.approx(0.12)
    assert result.truth.max_cross_track_m == pytest.approx(0.16)
    assert result.truth.path_m == pytest.approx(0.24)


def test_way_without_a_segment_is_not_driven_beyond_anything(tmp_path):
    truth = [(t, 0.0, 0.5 + 0.1 * t) for t in range(6)]
    result = run(tmp_path, truth, [(0.0, SegmentEvent(SEGMENT)), (1.5, SegmentEvent(None))])
    assert result.truth.driven_beyond_off_track_m == pytest.approx(0.1)


def test_localisation_errors_are_taken_at_the_time_of_the_estimate(tmp_path):
    turned = tuple(Rotation.from_euler("z", 2, degrees=True).as_quat())
    truth = [(0.0, 0.0, 0.0), (1.0, 0.1, 0.0, turned), (2.0, 0.2, 0.0, turned)]
    events = [(1.0, estimate(1.0, (0.1, 0.004, 0.0))), (2.0, estimate(1.5, (0.15, 0.0, 0.003)))]
    result = run(tmp_path, truth, events)
    found = result.localisation
    assert found.position_rmse_m == pytest.approx(math.sqrt((0.004**2 + 0.003**2) / 2))
    assert found.yaw_rmse_deg == pytest.approx(2.0)
    yaw = math.radians(2) / 0.01
    assert found.nees_mean == pytest.approx((0.4**2 + 0.3**2) / 2 + yaw**2)
    assert (found.count, found.failed) == (2, 0)


def test_consistent_estimates_have_a_mean_nees_near_six(tmp_path):
    rng = np.random.default_rng(1)
    truth = [(float(t), 0.01 * t, 0.0) for t in range(400)]
    events = []
    for t, x, y in truth:
        error = 0.002 * rng.standard_normal(6)
        quat = tuple(float(q) for q in Rotation.from_rotvec(-error[3:]).as_quat())
        events.append((t, estimate(t, (x - error[0], y - error[1], -error[2]), quat, 0.002)))
    result = run(tmp_path, truth, events)
    assert result.localisation.nees_mean == pytest.approx(6.0, abs=0.52)  # 3 sigma of a mean of 400


def test_failed_localisations_are_leaves_that_failed_for_vision(tmp_path):
    events = [
        (1.0, NodeChange("nav/localise", "failure", "not_seen")),
        (1.0, NodeChange("nav", "failure", "not_seen")),
        (2.0, NodeChange("nav/trek_to", "failure", "blocked")),
    ]
    result = run(tmp_path, [(0.0, 0.0, 0.0)], events)
    assert (result.localisation.count, result.localisation.failed) == (1, 1)


def test_strategy_row_joins_the_choice_with_its_verdict(tmp_path):
    def said(verdict):
        return StrategyEvent("back_off", "stuck", 0.8, 1, verdict, "because")

    events = [(5.0, said(Verdict.CHOSEN)), (9.0, said(Verdict.FAILED)), (11.0, said(Verdict.CHOSEN))]
    rows = run(tmp_path, [(0.0, 0.0, 0.0)], events).strategies
    assert [(r.t_s, r.t_end_s, r.helped) for r in rows] == [(5.0, 9.0, False), (11.0, None, None)]


def weigh(nominal, **others):
    rest = 1 - nominal - sum(others.values())
    return HypothesesEvent({"nominal": nominal, "marker_lost": rest, **others})


def test_each_stage_of_a_fault_has_its_time(tmp_path):
    events = [
        (8.0, weigh(0.6)),
        (9.0, FaultArmedEvent("led_off", "storm")),
        (10.0, FaultEvent("led_off", True, "marker_lost")),
        (12.0, weigh(0.6)),
        (13.0, weigh(0.1, overshoot=0.8)),
        (14.0, weigh(0.3)),
        (20.0, FaultEvent("led_off", False)),
        (30.0, weigh(0.8)),
    ]
    result = run(tmp_path, [(0.0, 0.0, 0.0)], events)
    (row,) = result.faults
    assert row == FaultStages(
        name="led_off",
        cause="storm",
        fired=True,
        t_armed_s=9.0,
        t_on_s=10.0,
        t_off_s=20.0,
        t_observable_s=12.0,
        t_detected_s=13.0,
        t_isolated_s=14.0,
        hypothesis="marker_lost",
        expected="marker_lost",
        t_recovered_s=30.0,
    )
    assert (row.concluded, row.latency_s(row.t_detected_s)) == ("marker_lost", 3.0)
    assert result.false_alarms == ()


def test_what_was_concluded_instead_is_told(tmp_path):
    events = [(10.0, FaultEvent("led_off", True, "marker_lost")), (13.0, weigh(0.1, overshoot=0.8))]
    (row,) = run(tmp_path, [(0.0, 0.0, 0.0)], events).faults
    assert (row.hypothesis, row.expected, row.t_isolated_s) == ("overshoot", "marker_lost", None)


def test_what_comes_long_after_a_passing_fault_is_about_something_else(tmp_path):
    events = [
        (10.0, FaultEvent("led_off", True, "marker_lost")),
        (20.0, FaultEvent("led_off", False)),
        (621.0, weigh(0.1)),
    ]
    (row,) = run(tmp_path, [(0.0, 0.0, 0.0)], events).faults
    assert (row.t_detected_s, row.hypothesis) == (None, None)


def test_an_alarm_before_any_fault_is_a_false_one(tmp_path):
    events = [
        (4.0, weigh(0.1)),
        (5.0, weigh(0.1)),
        (7.0, weigh(0.9)),
        (10.0, FaultEvent("led_off", True, "marker_lost")),
        (13.0, weigh(0.1)),
    ]
    result = run(tmp_path, [(0.0, 0.0, 0.0)], events)
    assert result.false_alarms == (FalseAlarm(4.0, "marker_lost"),)


def test_steepest_true_attitude_is_the_tilt(tmp_path):
    leaning = tuple(Rotation.from_euler("ZYX", [40, 6, 8], degrees=True).as_quat())
    result = run(tmp_path, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0, leaning), (2.0, 0.0, 0.0)], [])
    expected = math.degrees(math.acos(math.cos(math.radians(6)) * math.cos(math.radians(8))))
    assert result.truth.max_tilt_deg == pytest.approx(expected)
    assert result.truth.tether_max_n == pytest.approx(0.2)


def test_result_without_truth_keeps_its_keys_and_says_none(tmp_path):
    run(tmp_path, [], [(1.0, estimate(1.0, (0.1, 0.0, 0.0)))])
    result = summarise(tmp_path / "record.mcap", None)
    told = result.to_json()["truth"]
    assert set(told.values()) == {None}
    assert len(told) == 7
    assert result.localisation.nees_mean is None
    assert result.localisation.count == 1


def test_record_without_a_stop_is_an_error(tmp_path):
    result = run(tmp_path, [(0.0, 0.0, 0.0)], [])
    assert result.outcome == "error"
    assert "without a stop" in result.reason


def test_result_is_strict_json(tmp_path):
    figures = RunFigures(float("nan"), {"physics": float("inf")})
    result = run(tmp_path, [(0.0, float("nan"), 0.0)], [], figures)
    write_result(tmp_path / "result.json", result)
    read = json.loads((tmp_path / "result.json").read_text(), parse_constant=pytest.fail)
    assert read == result.to_json()
    assert read["wall_s"] is None
    assert read["wall"]["physics"] is None


def test_a_result_reads_back_as_it_was_written(tmp_path):
    events = [(4.0, weigh(0.1)), (10.0, FaultEvent("led_off", True, "marker_lost")), (13.0, weigh(0.1))]
    result = run(tmp_path, [(0.0, 0.0, 0.0)], events)
    write_result(tmp_path / "result.json", result)
    assert read_result(tmp_path / "result.json") == result


def test_keys_of_a_newer_result_are_left_out():
    assert RunResult.from_json({"outcome": "help", "from_the_future": 3}) == RunResult(outcome="help")


def test_the_keys_of_a_result_are_those_of_the_contract():
    assert list(RunResult(safety=()).to_json()) == [
        *("schema", "scenario", "seed", "tier", "digest", "outcome", "reason", "mission_s", "wall_s", "wall"),
        *("waypoints", "truth", "localisation", "strategies", "faults", "false_alarms", "expectations"),
        "safety",
    ]


@pytest.mark.parametrize("text", ["{", "[]", '{"outcome": 3}', '{"faults": [{"fired": true}]}'])
def test_what_is_no_result_is_refused(tmp_path, text):
    (tmp_path / "result.json").write_text(text)
    with pytest.raises(RecordError):
        read_result(tmp_path / "result.json")
