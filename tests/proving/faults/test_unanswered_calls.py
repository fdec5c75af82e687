"""A call for help that ground leaves open: the run ends as one that has called, whatever comes first."""

import pytest

from tests.proving.faults.scenario import run

BLIND = {"frozen_frame": {}, "name": "blind", "from": {"time": "1 min"}}
LATE = {"link_delay": {"by": "30 h"}}
LOST = {"link_drop": {"patience": "10 d"}}
CUT_OFF = {"link_outage": {"patience": "10 d"}}
ROOT = "tree: own\nports: {route: {type: Route, direction: in}}\nroot:\n  "


def unanswered(folder, fault, **head):
    return run(folder, BLIND, fault | {"from": {"time": "0 s"}}, **head)


def mission(folder, root):
    """The short mission under a tree with this root."""
    (folder / "own.yaml").write_text(ROOT + root)
    waypoints = [{"x": "2 m", "y": "0 m"}, {"x": "2.2 m", "y": "0 m"}]
    return {"mission": "short", "tree": "own.yaml", "waypoints": waypoints}


@pytest.mark.parametrize(("fault", "limit"), [(LATE, "1 h"), (LATE, "24 h"), (LOST, "1 h"), (CUT_OFF, "1 h")])
def test_an_unanswered_call_ends_in_help_whatever_the_time_limit(tmp_path, fault, limit):
    done = unanswered(tmp_path, fault, time_limit=limit)
    assert (done.outcome, done.breaches()) == ("help", [])
    assert "no strategy fits" in (done.finished.result.reason or "")
    (called_s,) = done.times("link", "call")
    assert [t for t in done.times("tracks", "drive") if t >= called_s] == []


def test_the_patience_of_a_call_is_its_own(tmp_path):
    impatient = mission(tmp_path, "{sequence: [{call_for_help: {patience: 90 s}}]}\n")
    done = unanswered(tmp_path, LATE, mission=impatient)
    assert done.finished.result.mission_s < 100


def test_a_run_that_goes_on_after_its_call_ends_by_the_time_limit(tmp_path):
    goes_on = mission(tmp_path, "{selector: [{call_for_help: {}}, {wait: {duration: 2 h}}]}\n")
    assert run(tmp_path, mission=goes_on, time_limit="20 min").outcome == "time_limit"
