"""Faults of a scenario, run from its file on the fake robot: onset, end, evidence, exit code."""

import json

import pytest

from executive.cli import invoke
from executive.core import registry
from executive.core.types import PoseEstimate
from executive.record import History, events
from executive.run.app import RunOptions, run
from executive.run.fault import FAULT_KIND, load_fault

SCENARIO = """\
scenario: short
mission:
  mission: short
  waypoints:
    - {x: 2.0 m, y: 0 m}
    - {x: 2.4 m, y: 0 m}
    - {x: 2.8 m, y: 0.1 m}
backend: fake
localizer: overhead
tier: geometric
expect: {outcome: reached}
faults:
"""


@pytest.fixture
def finished(tmp_path):
    """Runs the scenario with these faults; the result and the record."""

    def finish(faults):
        file = tmp_path / "short.yaml"
        file.write_text(SCENARIO + faults)
        done = run(file, RunOptions(out=tmp_path / "run", bar=False))
        return done, History.of(done.folder / "record.mcap")

    return finish


def told(record):
    return [(at.time_s, at.event.name, at.event.active) for at in record.all(events.FaultEvent)]


def first(record, kind, what):
    return next(at.time_s for at in record.all(kind) if what(at.event))


def test_a_fault_begins_and_ends_in_its_time(finished):
    done, record = finished(
        "  - encoder_scale: {side: left, factor: 103 %}\n    from: {time: 2 min}\n    for: 5 min\n"
    )
    (on, off) = told(record)
    assert 120.0 <= on[0] < 260.0  # when the rover next moved
    assert off == (420.0, "encoder_scale", False)
    (row,) = done.result.faults
    assert (row.fired, row.t_on_s, row.t_off_s) == (True, on[0], 420.0)
    assert (row.t_armed_s, row.expected) == (120.0, "track_asymmetry")
    assert (done.result.outcome, done.exit_code) == ("reached", 0)


@pytest.mark.parametrize(
    ("trigger", "kind", "what"),
    [
        ("{waypoint: 1}", events.WaypointEvent, lambda e: e.index == 1),
        ("{progress: 50 %}", events.WaypointEvent, lambda e: e.index == 1),
        ("{node: set_leg, count: 2}", events.NodeChange, lambda e: e.path.endswith("/set_leg")),
    ],
)
def test_a_fault_waits_for_its_trigger(finished, trigger, kind, what):
    _, record = finished(f"  - encoder_scale: {{side: left, factor: 103 %}}\n    from: {trigger}\n")
    on = told(record)[0][0]
    reached = first(record, kind, what) if kind is events.WaypointEvent else 0.0
    second = [at.time_s for at in record.all(events.SegmentEvent)][1]
    assert on >= min(reached or second, second)
    assert on <= second + 120.0


def test_a_fault_may_wait_for_a_strategy(finished):
    _, record = finished(
        "  - frozen_frame: {}\n    name: first\n    from: {node: localise, count: 3}\n    for: 10 min\n"
        "  - encoder_scale: {side: left, factor: 103 %}\n    from: {strategy: cabin_reposing}\n"
    )
    chosen = first(record, events.StrategyEvent, lambda e: e.name == "cabin_reposing")
    assert next(t for t, name, active in told(record) if name == "encoder_scale" and active) > chosen


def test_a_fault_that_never_fired_makes_the_run_invalid(finished):
    done, record = finished("  - frozen_frame: {}\n    name: late\n    from: {time: 20 h}\n")
    assert done.result.outcome == "invalid"
    assert done.result.reason == "late never took effect; the run ended reached"
    assert done.exit_code == 1
    assert [(row.name, row.fired) for row in done.result.faults] == [("late", False)]
    assert record.last(events.Stop).event.outcome == "invalid"


def test_a_fault_that_was_on_but_changed_nothing_makes_the_run_invalid(finished):
    done, _ = finished("  - encoder_scale: {side: left}\n    from: {time: 0 s}\n    for: 3 s\n")
    assert done.result.outcome == "invalid"


def test_the_catalogue_lists_every_fault_with_its_parameters(capsys):
    assert invoke(["faults", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert {"led_off", "rock_on_path", "frozen_frame", "encoder_scale"} <= set(listed)
    assert listed["led_off"]["hypothesis"] == "marker_lost"
    assert listed["led_off"]["backends"] == ["pybullet"]
    assert "marker" in listed["led_off"]["model"]
    assert all(fault["doc"] for fault in listed.values())


def test_every_fault_leads_to_a_hypothesis_that_exists():
    for name in registry.names(FAULT_KIND):
        assert load_fault(name).name == name  # checked there


def rows(done):
    return {row.name: row for row in done.result.faults}


def test_a_fault_may_wait_for_what_the_record_shows(finished):
    done, record = finished("  - encoder_scale: {side: left}\n    from: {when: 'moving and x > 2.05 m'}\n")
    armed = first(record, events.FaultArmedEvent, lambda e: True)
    poses = [at for at in record.all(PoseEstimate) if at.time_s <= armed]
    assert poses[-1].event.x_m > 2.05
    assert rows(done)["encoder_scale"].t_armed_s == armed


def test_a_fault_may_wait_for_a_phase(finished):
    done, record = finished("  - encoder_scale: {side: left}\n    from: {phase: driving, count: 2}\n")
    drives = [
        at.time_s
        for at in record.all(events.Command)
        if (at.event.device, at.event.verb) == ("tracks", "drive")
        and at.event.values["left_m"] * at.event.values["right_m"] >= 0
    ]
    armed = rows(done)["encoder_scale"].t_armed_s
    assert drives[1] <= armed <= drives[1] + 1.0


def test_a_group_comes_and_goes_together(finished):
    done, _ = finished(
        "  - group: storm\n    from: {node: localise, count: 2}\n    for: 8 min\n    faults:\n"
        "      - frozen_frame: {}\n      - encoder_scale: {side: left}\n"
    )
    told = rows(done)
    assert {row.cause for row in told.values()} == {"storm"}
    assert told["frozen_frame"].t_armed_s == told["encoder_scale"].t_armed_s
    assert told["frozen_frame"].t_off_s == told["frozen_frame"].t_armed_s + 480.0


def test_a_fault_that_comes_and_goes_acts_only_while_it_is_there(finished):
    _, record = finished(
        "  - frozen_frame: {}\n    from: {time: 3 min}\n"
        "    profile: {intermittent: {period: 4 min, duty: 25 %}}\n"
    )
    fixes = [at.time_s - 180.0 for at in record.all(PoseEstimate) if at.event.is_fix]
    assert any(t > 240.0 for t in fixes)
    assert not any(2.0 < t % 240.0 < 58.0 for t in fixes if t > 0)


def test_what_was_left_to_chance_is_written_with_the_run(finished):
    faults = "  - encoder_scale: {side: {choice: [left, right]}, factor: {uniform: [101 %, 104 %]}}\n"
    done, _ = finished(faults)
    again = run(done.folder / "scenario.yaml", RunOptions(out=done.folder / "again", bar=False))
    assert again.result.digest == done.result.digest
    assert "uniform" not in (done.folder / "scenario.yaml").read_text()


def test_equal_profiles_without_a_cause_come_each_in_its_own_time(finished):
    entry = (
        "  - encoder_scale: {side: SIDE, factor: 101 %}\n    name: SIDE\n    from: {time: 0 s}\n"
        "    profile: {random: {every: 4 min, lasts: 20 s}}\n"
    )
    done, _ = finished(entry.replace("SIDE", "left") + entry.replace("SIDE", "right"))
    told = rows(done)
    assert told["left"].t_on_s != told["right"].t_on_s
