"""Faults of a scenario, run from its file on the fake robot: onset, end, evidence, exit code."""

import json

import pytest

from executive.app import RunOptions, run
from executive.cli import invoke
from executive.telemetry import History, events

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
    (row,) = done.result["faults"]
    assert (row["fired"], row["t_on_s"], row["t_off_s"]) == (True, on[0], 420.0)
    assert row["hypothesis"] == "track_asymmetry"
    assert (done.result["outcome"], done.exit_code) == ("reached", 0)


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
    assert done.result["outcome"] == "invalid"
    assert done.result["reason"] == "late never took effect; the run ended reached"
    assert done.exit_code == 1
    assert [(row["name"], row["fired"]) for row in done.result["faults"]] == [("late", False)]
    assert record.last(events.Stop).event.outcome == "invalid"


def test_a_fault_that_was_on_but_changed_nothing_makes_the_run_invalid(finished):
    done, _ = finished("  - encoder_scale: {side: left}\n    from: {time: 0 s}\n    for: 3 s\n")
    assert done.result["outcome"] == "invalid"


def test_the_catalogue_lists_every_fault_with_its_parameters(capsys):
    assert invoke(["faults", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert {"led_off", "rock_on_path", "frozen_frame", "encoder_scale"} <= set(listed)
    assert listed["led_off"]["hypothesis"] == "marker_lost"
    assert listed["led_off"]["backends"] == ["pybullet"]
    assert "marker" in listed["led_off"]["model"]
    assert all(fault["doc"] and fault["hypothesis"] for fault in listed.values())


def test_every_fault_leads_to_a_hypothesis_that_exists():
    from executive import plugins
    from executive.faults import FaultSpec
    from executive.hypotheses import Hypothesis

    for name in plugins.found(plugins.FAULTS):
        spec = plugins.load(plugins.FAULTS, name, FaultSpec)
        assert spec.name == name
        assert spec.hypothesis in set(Hypothesis)
