"""What nodes did is held against what was expected of them: order, absence, and count."""

from __future__ import annotations

from pathlib import Path

import pytest

from executive.record import History, Recorder
from executive.record.events import NodeChange
from proving.judge.expect import Times
from proving.judge.node_ends import (
    ends,
    in_order,
    never,
    times,
)

TREK, BACK_OFF = "navigate/trek_to/loop/sequence", "navigate/recover/back_off/sequence"
TOLD = [
    (1.0, f"{TREK}/drive_leg", "running", ""),
    (2.0, f"{TREK}/watch", "running", ""),
    (3.0, f"{TREK}/drive_leg", "failure", "blocked"),
    (3.0, f"{TREK}/watch", "invalid", ""),
    (3.0, f"{TREK}/idle", "invalid", ""),
    (4.0, f"{BACK_OFF}/localise", "success", ""),
    (5.0, f"{BACK_OFF}/localise#2", "success", ""),
]


@pytest.fixture
def seen(tmp_path: Path):
    with Recorder(tmp_path / "record.mcap") as recorder:
        for time_s, *change in TOLD:
            recorder.write(NodeChange(*change), time_s)
    return ends(History.of(tmp_path / "record.mcap"))


def met(rows) -> list[bool]:
    return [row.met for row in rows]


def test_a_node_ends_by_success_failure_with_its_reason_or_halted_if_it_was_under_way(seen) -> None:
    assert [(end.path.rsplit("/", 1)[-1], sorted(end.words)) for end in seen] == [
        ("drive_leg", ["blocked", "failure"]),
        ("watch", ["halted"]),
        ("localise", ["success"]),
        ("localise#2", ["success"]),
    ]


def test_steps_in_order_are_met_whatever_lies_between(seen) -> None:
    steps = [{"drive_leg": "blocked"}, {"back_off/localise#2": "success"}]
    assert met(in_order(steps, seen, 9.0)) == [True, True]


def test_steps_of_one_tick_may_stand_in_any_order(seen) -> None:
    assert met(in_order([{"watch": "halted"}, {"drive_leg": "failure"}], seen, 9.0)) == [True, True]


def test_after_a_step_that_did_not_come_no_step_is_met(seen) -> None:
    steps = [{"back_off/localise#2": "success"}, {"drive_leg": "blocked"}, {"back_off/localise": "success"}]
    rows = list(in_order(steps, seen, 9.0))
    assert met(rows) == [True, False, False]
    assert rows[1].text == "step 2: drive_leg blocked"
    assert rows[1].t_violation_s == 9.0


def test_one_end_answers_one_step_only(seen) -> None:
    assert met(in_order([{"drive_leg": "blocked"}, {"drive_leg": "blocked"}], seen, 9.0)) == [True, False]


def test_never_tells_when_it_came_first(seen) -> None:
    rows = list(never([{"drive_leg": "tilt"}, {"localise": "success"}], seen))
    assert met(rows) == [True, False]
    assert rows[1].t_violation_s == 4.0


@pytest.mark.parametrize(
    ("at_least", "at_most", "holds", "spare", "violated_s"),
    [
        (0, 2, True, 0, None),
        (2, None, True, 0, None),
        (3, None, False, -1, 9.0),
        (0, 1, False, -1, 5.0),
        (1, 5, True, 1, None),
    ],
)
def test_times_counts_ends_and_tells_when_it_was_one_too_many(
    seen, at_least, at_most, holds, spare, violated_s
) -> None:
    wanted = Times(of={"localise": "success"}, at_least=at_least, at_most=at_most)
    (row,) = times([wanted], seen, 9.0)
    assert (row.met, row.robustness, row.t_violation_s) == (holds, spare, violated_s)
