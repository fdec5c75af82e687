"""Faults of the executive itself, in whole runs on the fake robot."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from executive.core.types import PoseEstimate
from executive.record import History, events
from executive.record.reader import is_complete
from tests.proving.faults.scenario import complaint, run, write

ROOT = Path(__file__).resolve().parents[3]
EARLY = {"from": {"time": "1 min"}}
BLIND = {"frozen_frame": {}, "name": "blind", **EARLY}


def forced(status, at, node="localise"):
    return {"node_forced": {"node": node, "status": status, "at": at}, **EARLY}


def changes(done, name):
    """The status changes of the nodes of one name, from the onset on."""
    told = done.record.all(events.NodeChange)
    return [at.event for at in told if at.event.path.endswith(f"/{name}") and at.time_s >= 60.0]


def test_a_node_forced_before_its_tick_does_nothing(tmp_path):
    done = run(tmp_path, forced("failure", "before"))
    fixes = [at for at in done.record.all(PoseEstimate) if at.event.is_fix]
    assert max(at.time_s for at in fixes) < 60.0
    assert done.outcome == "help"
    assert done.rows["node_forced"].fired
    assert done.breaches() == []


def test_a_node_forced_after_its_tick_has_done_its_work(tmp_path):
    done = run(tmp_path, forced("success", "after", "facing"))
    assert {change.status for change in changes(done, "facing")} - {"invalid"} == {"success"}
    assert done.rows["node_forced"].fired
    assert done.breaches() == []


def test_a_node_forced_to_fail_for_a_reason_is_answered_for_it_once(tmp_path):
    fault = {"node_forced": {"node": "trek_to/localise", "reason": "poor_view", "times": 1}, **EARLY}
    done = run(tmp_path, fault)
    assert [change.reason for change in changes(done, "localise") if change.reason] == ["poor_view"]
    assert done.record.all(events.StrategyEvent)[0].event.name == "cabin_reposing"
    assert done.outcome == "reached"
    assert done.breaches() == []


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"status": "success", "reason": "blocked"}, "got the reason blocked of a success"),
        ({"reason": "blokced"}, 'did you mean "blocked"'),
        ({"reason": "done"}, "got the reason done of a failure"),
    ],
)
def test_only_a_forced_failure_has_a_reason_and_one_that_nodes_know(tmp_path, capsys, more, said):
    assert said in complaint(tmp_path, capsys, {"node_forced": {"node": "localise"} | more})


@pytest.mark.parametrize("at", ["before", "after"])
def test_a_node_forced_to_run_keeps_the_rover_at_rest_until_the_time_is_up(tmp_path, at):
    done = run(tmp_path, forced("running", at))
    assert done.outcome == "time_limit"
    assert done.breaches() == []


def test_a_node_forced_for_a_while_takes_up_its_work_again(tmp_path):
    done = run(tmp_path, forced("running", "before") | {"for": "10 min"})
    assert done.outcome == "reached"
    assert done.rows["node_forced"].t_off_s == 660.0
    assert done.breaches() == []


def test_a_hanging_drive_ends_by_itself_and_no_other_begins(tmp_path):
    done = run(tmp_path, {"node_hangs": {"node": "drive_leg"}, **EARLY})
    assert done.outcome == "time_limit"
    onset_s = done.rows["node_hangs"].t_on_s
    assert [t for t in done.times("tracks", "drive") if t > onset_s] == []
    assert done.breaches() == []


def test_a_node_that_hung_for_a_while_goes_on(tmp_path):
    done = run(tmp_path, {"node_hangs": {"node": "localise"}, **EARLY, "for": "10 min"})
    assert done.outcome == "reached"
    assert done.breaches() == []


@pytest.mark.parametrize("at", ["before", "after"])
@pytest.mark.parametrize("node", ["drive_leg", "localise", "recover"])
def test_a_node_that_raises_ends_the_run_as_an_error_with_the_evidence(tmp_path, node, at):
    done = run(tmp_path, {"node_raises": {"node": node, "at": at}, **EARLY})
    assert (done.outcome, done.finished.exit_code) == ("error", 3)
    assert f"/{node}: Injected: raised by injection" in done.finished.result.reason
    assert done.rows["node_raises"].fired
    assert done.breaches() == []


def test_late_ticks_slow_the_mission_and_do_not_break_it(tmp_path):
    done = run(tmp_path, {"late_tick": {"by": "20 s"}, **EARLY})
    assert done.outcome == "reached"
    assert done.finished.result.mission_s > 1.3 * run(tmp_path / "..").finished.result.mission_s
    assert done.breaches() == []


@pytest.mark.parametrize(
    ("value", "kind"),
    [*(("pose", kind) for kind in ("nan", "none", "scaled", "stale")), ("segment", "nan"), ("leg", "nan")],
)
def test_a_corrupted_value_leaves_the_rover_safe(tmp_path, value, kind):
    done = run(tmp_path, {"value_corrupted": {"value": value, "kind": kind}, **EARLY})
    assert done.outcome in ("reached", "help", "safe_hold", "time_limit", "error", "invalid")
    assert done.breaches() == []


def test_a_way_point_is_not_reached_because_the_plan_has_forgotten_it(tmp_path):
    done = run(tmp_path, {"value_corrupted": {"value": "segment", "kind": "stale"}, **EARLY})
    assert done.outcome == "safe_hold"
    assert done.finished.result.reason == "2 of 3 way-points were reached; not way-point 2"


def test_a_way_point_is_not_reached_because_a_node_says_so(tmp_path):
    done = run(tmp_path, forced("success", "before", "trek_to"))
    assert done.outcome == "help"
    assert "outside of its tolerance" in done.finished.result.reason


def test_a_pose_that_is_no_number_never_steers(tmp_path):
    done = run(tmp_path, {"pose_nan": {}, **EARLY})
    assert done.outcome == "help"
    assert "the pose found is no number" in done.finished.result.reason
    assert done.breaches() == []


def test_an_old_pose_is_refused(tmp_path):
    done = run(tmp_path, {"pose_stale": {}, **EARLY})
    assert done.outcome == "help"
    assert "older than the question" in done.finished.result.reason


def test_a_stuck_encoder_stops_the_drive_before_the_belt_has_run_far(tmp_path):
    done = run(tmp_path, {"encoder_stuck": {"side": "left"}, **EARLY})
    assert done.outcome == "help"
    assert "the left belt counted" in done.finished.result.reason


def test_a_missing_strategy_is_passed_over_where_it_would_have_been_chosen(tmp_path):
    fault = {"strategy_missing": {"strategy": "wait_for_sight"}, "from": {"time": "0 s"}}
    done = run(tmp_path, fault, BLIND | {"for": "30 min"})
    assert done.rows["strategy_missing"].fired
    assert "wait_for_sight" not in {row.name for row in done.finished.result.strategies}


def test_a_missing_strategy_that_nobody_asked_for_proves_nothing(tmp_path):
    fault = {"strategy_missing": {"strategy": "back_off"}, "from": {"time": "0 s"}}
    assert run(tmp_path, fault).outcome == "invalid"


def test_a_wrong_strategy_does_nothing_and_is_found_out(tmp_path):
    fault = {"strategy_wrong": {"strategy": "wait_for_sight"}, "from": {"time": "0 s"}}
    done = run(tmp_path, fault, BLIND)
    assert "wait_for_sight" in {row.name for row in done.finished.result.strategies}
    assert changes(done, "wait_for_sight/sequence/wait") == []
    assert done.outcome == "help"


def test_a_slow_strategy_begins_late_and_helps_all_the_same(tmp_path):
    def waited_s(*faults):
        done = run(tmp_path, *faults, BLIND | {"for": "15 min"})
        (row,) = [r for r in done.finished.result.strategies if r.name == "wait_for_sight"]
        assert (done.outcome, row.helped) == ("reached", True)
        return row.t_end_s - row.t_s

    slow = {"strategy_slow": {"strategy": "wait_for_sight", "by": "10 min"}, "from": {"time": "0 s"}}
    assert waited_s(slow) == waited_s() + 600.0


def test_what_is_not_there_cannot_be_faulty(tmp_path, capsys):
    said = complaint(
        tmp_path,
        capsys,
        {"node_hangs": {"node": "drive_leg"}, "name": "good"},
        {"node_hangs": {"node": "drive_legg"}},
        {"strategy_slow": {"strategy": "wait_for_sigt"}},
        {"value_corrupted": {"value": "pos"}},
    )
    assert (
        'got the node "drive_legg", which the tree navigate does not have; did you mean "drive_leg"?' in said
    )
    assert 'got the unknown strategy "wait_for_sigt"; did you mean "wait_for_sight"?' in said
    assert 'got the value "pos", which the tree navigate does not have; did you mean "pose"?' in said


def test_a_killed_process_has_written_down_that_it_would_be(tmp_path):
    file = write(tmp_path, {"process_killed": {}, **EARLY})
    command = [
        sys.executable,
        "-c",
        "from executive.cli import main; main()",
        "run",
        str(file),
        "--quiet",
    ]
    command += ["--out", str(tmp_path / "run")]
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(command, env=os.environ | {"PYTHONPATH": paths}, check=False)
    assert done.returncode == -signal.SIGKILL
    record = tmp_path / "run" / "record.mcap"
    assert not is_complete(record)
    (told,) = History.of(record).all(events.FaultEvent)
    assert (told.time_s, told.event.name, told.event.active) == (60.0, "process_killed", True)
