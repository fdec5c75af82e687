"""When a fault's time has come, from events as the record is told them."""

import numpy as np
import pytest

from executive.core.types import (
    Call,
    PoseEstimate,
    Reason,
)
from executive.record import events
from proving.inject.onsets import Onset, Sightings
from proving.inject.triggers import Trigger


def telemetry(tilt_rad):
    values = dict.fromkeys(events.Telemetry.__dataclass_fields__, 0.0) | {"moving": False}
    return events.Telemetry(**values | {"pitch_rad": tilt_rad})


def onset(**trigger):
    return Onset(Trigger.model_validate(trigger))


def due_times(begin, told):
    """Feeds (time, event or None) pairs; the times at which the onset says it is due."""
    seen = Sightings()
    due = []
    for time_s, event in told:
        if event is not None:
            seen.hear(event)
        if begin.due(seen, time_s, 0.0):
            due.append(time_s)
    return due


def test_a_condition_is_due_as_soon_as_it_holds():
    told = [(0, None), (1, telemetry(0.01)), (2, telemetry(0.3)), (3, telemetry(0.01))]
    assert due_times(onset(when="tilt > 5 deg"), told) == [2]


def test_a_signal_that_was_never_told_makes_no_condition_true():
    assert due_times(onset(when="not tilt > 5 deg"), [(0, None), (1, None)]) == []


def test_a_rise_asks_that_it_did_not_hold_before():
    told = [(0, telemetry(0.3)), (1, telemetry(0.3)), (2, telemetry(0.0)), (3, telemetry(0.3))]
    assert due_times(onset(when="tilt > 5 deg", edge="rise"), told) == [3]


def test_a_fall_is_when_it_ceases_to_hold():
    told = [(0, telemetry(0.0)), (1, telemetry(0.3)), (2, telemetry(0.0))]
    assert due_times(onset(when="tilt > 5 deg", edge="fall"), told)[0] == 2


def test_a_held_condition_must_hold_without_a_break():
    levels = [0.3, 0.3, 0.0, 0.3, 0.3, 0.3, 0.3]
    told = [(float(t), telemetry(level)) for t, level in enumerate(levels)]
    assert due_times(onset(when="tilt > 5 deg", held="3 s"), told) == [6.0]


@pytest.mark.parametrize(
    ("phase", "event"),
    [
        ("driving", events.Command("tracks", "drive", {"left_m": 0.1, "right_m": 0.1})),
        ("turning", events.Command("tracks", "drive", {"left_m": -0.1, "right_m": 0.1})),
        ("localising", events.Command("cameras", "take", {})),
        ("recovering", events.StrategyEvent("back_off", "x", 0.9, 1, events.Verdict.CHOSEN)),
        ("calling", Call(0.0, Reason.TILT, "steep")),
    ],
)
def test_a_phase_begins_with_what_it_is_about(phase, event):
    others = [p for p in ("driving", "turning", "localising", "recovering", "calling") if p != phase]
    assert due_times(onset(phase=phase), [(0, None), (1, event)]) == [1]
    assert all(due_times(onset(phase=other), [(1, event)]) == [] for other in others)


def test_a_count_waits_for_so_many_entries():
    chosen = events.StrategyEvent("back_off", "x", 0.9, 1, events.Verdict.CHOSEN)
    failed = events.StrategyEvent("back_off", "x", 0.9, 1, events.Verdict.FAILED)
    told = [(1, chosen), (2, failed), (3, chosen), (4, None)]
    assert due_times(onset(strategy="back_off", count=2), told) == [3, 4]


def test_a_node_that_ends_in_the_tick_it_began_counts_as_entered():
    def change(status):
        return events.NodeChange("t/sequence/localise#2", status)

    told = [(1, change("success")), (2, change("running")), (3, change("running")), (4, change("invalid"))]
    assert due_times(onset(node="localise", count=2), told) == [2, 3, 4]


def test_believed_poses_are_signals():
    pose = PoseEstimate(0.0, (3.0, 0.5, 0.0), (0, 0, 0, 1), np.eye(6), "markers")
    assert due_times(onset(when="x > 2.9 m and y < 1 m"), [(0, None), (1, pose)]) == [1]
