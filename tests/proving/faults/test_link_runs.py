"""A call for help over a faulty link: the rover rests, and the run ends with the call all the same."""

import pytest

from tests.proving.faults.scenario import run

BLIND = {"frozen_frame": {}, "name": "blind", "from": {"time": "1 min"}}
FAULTS = [
    {"link_delay": {"by": "20 min"}},
    {"link_drop": {"patience": "20 min"}},
    {"link_outage": {"patience": "20 min"}},
    {"link_duplicate": {}},
    {"replayed_uplink": {"answer": "go on"}},
]


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: next(iter(fault)))
def test_a_call_over_a_faulty_link_ends_in_help_at_rest(tmp_path, fault):
    done = run(tmp_path, BLIND, fault | {"from": {"time": "0 s"}})
    assert done.outcome == "help"
    assert done.rows[next(iter(fault))].fired
    (called_s,) = done.times("link", "call")
    assert [t for t in done.times("tracks", "drive") if t >= called_s] == []
    assert done.breaches() == []


def test_a_link_fault_without_a_call_proves_nothing(tmp_path):
    done = run(tmp_path, {"link_drop": {}})
    assert (done.outcome, done.finished.exit_code) == ("invalid", 1)
