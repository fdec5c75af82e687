import json

import pytest

from executive.cli import invoke
from executive.core.errors import ConfigError, RecordError
from executive.core.types import Call, Reason
from executive.record import Recorder, TruthRecorder
from executive.record.events import (
    Command,
    FaultEvent,
    HypothesesEvent,
    Level,
    LogEvent,
    NodeChange,
    Start,
    Stop,
    StrategyEvent,
    Verdict,
)
from executive.record.run_result import FaultStages
from executive.report.explain import as_text, explain

TREE = "go/selector/recover"
STORY = (
    (0, NodeChange("go/selector", "running")),
    (0, NodeChange(TREE, "running")),
    (0, NodeChange(f"{TREE}/loop", "running")),
    (0, NodeChange(f"{TREE}/loop/arrived", "failure", "unexpected", "1.2 m to go")),
    (0, NodeChange(f"{TREE}/loop/drive_leg", "running")),
    (1, Command("tracks", "drive", {"left_m": 0.1, "right_m": 0.1, "speed_m_s": 0.0014})),
    (20, FaultEvent("rock", True, "stuck_on_obstacle")),
    (30, NodeChange(f"{TREE}/loop/drive_leg", "failure", "blocked", "motor current 0.9 A")),
    (30, NodeChange(f"{TREE}/loop", "failure")),
    (30, HypothesesEvent({"nominal": 0.2, "stuck_on_obstacle": 0.7, "tether_snag": 0.1}, 90.0)),
    (30, StrategyEvent("back_off", "stuck_on_obstacle", 0.7, 1, Verdict.CHOSEN, "answers stuck_on_obstacle")),
    (31, NodeChange(f"{TREE}/back_off", "running")),
    (31, NodeChange(f"{TREE}/back_off/drive_straight", "running")),
    (50, NodeChange(f"{TREE}/back_off/drive_straight", "failure", "blocked", "stuck there as well")),
    (50, NodeChange(f"{TREE}/back_off", "failure")),
    (50, StrategyEvent("back_off", "stuck_on_obstacle", 0.7, 1, Verdict.FAILED)),
    (50, LogEvent(Level.WARNING, "pool", "no strategy for stuck_on_obstacle (detour: no room)")),
    (50, LogEvent(Level.INFO, "navigate", "not of the pool")),
    (50, NodeChange(TREE, "failure")),
    (50, NodeChange("go/selector/call_for_help", "running")),
    (50, Call(50.0, Reason.NO_STRATEGY, "no strategy fits")),
    (90, NodeChange("go/selector/call_for_help", "failure", "no_strategy", "ground has not answered")),
    (90, NodeChange("go/selector", "failure")),
    (90, Stop("help", "no_strategy: no strategy fits")),
)


@pytest.fixture
def folder(tmp_path):
    with Recorder(tmp_path / "record.mcap") as record:
        record.write(Start("told", "", 3, 1.0), 0.0)
        for time_s, event in STORY:
            record.write(event, float(time_s))
    return tmp_path


def names(chain):
    return [link.name for link in chain]


def test_the_chain_leads_from_the_running_leaf_to_the_root(folder):
    found = explain(folder, "10 s")
    assert names(found.chain) == ["drive_leg", "loop", "recover", "selector"]
    assert {link.status for link in found.chain} == {"running"}
    assert found.failure == ()  # the loop's question was answered with no, which is no failure


def test_what_was_not_yet_known_is_not_told(folder):
    found = explain(folder, "10 s")
    assert found.hypotheses == {}
    assert (found.strategies, found.refusals, found.calls, found.faults) == ((), (), (), ())


def test_a_failure_that_the_pool_answers_is_named_with_the_answer(folder):
    found = explain(folder, "40 s")
    assert names(found.chain) == ["drive_straight", "back_off", "recover", "selector"]
    assert names(found.failure) == ["drive_leg", "loop", "recover", "selector"]
    assert (found.failure[0].reason, found.failure[0].since_s) == ("blocked", 30.0)
    assert found.failure[-1].status == "running"
    assert list(found.hypotheses) == ["stuck_on_obstacle", "nominal", "tether_snag"]
    assert found.strategies[0].helped is None
    assert found.faults == (FaultStages("rock", fired=True, t_on_s=20.0, expected="stuck_on_obstacle"),)


def test_by_default_the_end_is_explained_and_the_failure_behind_it(folder):
    found = explain(folder)
    assert found.at_s == 90.0
    assert names(found.chain) == ["call_for_help", "selector"]
    assert found.failure[0].detail == "stuck there as well"
    assert found.strategies[0].helped is False
    assert [at.event for at in found.refusals] == ["no strategy for stuck_on_obstacle (detour: no room)"]
    assert [at.event.reason for at in found.calls] == [Reason.NO_STRATEGY]


def test_faults_of_the_world_are_told_from_the_simulators_record(folder):
    with TruthRecorder(folder / "truth.mcap") as truth:
        truth.write(FaultEvent("slip", True), 5.0)
        truth.write(FaultEvent("slip", False), 15.0)
    slip, rock = explain(folder).faults
    assert (slip.name, slip.t_off_s) == ("slip", 15.0)
    assert rock.name == "rock"


def test_the_text_says_it_in_words_with_units(folder):
    text = as_text(explain(folder))
    assert text.startswith("told, seed 3: help after 1 min 30 s\n")
    for words in (
        "✗ drive_straight  failure",
        "0.70  stuck_on_obstacle",
        "back_off, attempt 1, against stuck_on_obstacle at 0.70: answers stuck_on_obstacle; did not help",
        "detour: no room",
        "tracks drive: left 0.1 m, right 0.1 m, speed 0.0014 m/s",
        "rock: still active; expected diagnosis stuck_on_obstacle",
        "crossed in 1 min 30 s",
    ):
        assert words in text


def test_a_record_cut_off_is_explained_up_to_where_it_ends(folder):
    record = folder / "record.mcap"
    content = record.read_bytes()
    record.write_bytes(content[: content.index(b"back_off")])
    found = explain(folder)
    assert found.outcome is None
    assert "the record was cut off" in as_text(found)


def test_an_empty_record_says_that_nothing_had_been_ticked(tmp_path):
    Recorder(tmp_path / "record.mcap").close()
    assert "nothing had been ticked" in as_text(explain(tmp_path))


@pytest.mark.parametrize("at", ["91 s", "-1 s", "3 mm", "soon", "1 h"])
def test_a_time_that_is_none_or_outside_the_record_is_refused(folder, at):
    with pytest.raises(ConfigError, match=r"--at:1:1: got '.*', expected a"):
        explain(folder, at)


def test_a_bare_number_counts_as_seconds(folder):
    assert explain(folder, "40").at_s == explain(folder, "40 s").at_s == 40.0


def test_no_record_is_an_error_for_the_user(tmp_path):
    with pytest.raises(RecordError, match=r"no record\.mcap"):
        explain(tmp_path)


def test_the_command_prints_text_or_json(folder, capsys):
    assert invoke(["explain", str(folder), "--at", "40 s"]) == 0
    assert "What was tried, and why:" in capsys.readouterr().out
    assert invoke(["explain", str(folder), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["chain"][0]["path"] == "go/selector/call_for_help"
    assert found["refusals"][0]["t_s"] == 50.0
    assert invoke(["explain", str(folder), "--at", "3 h"]) == 2
