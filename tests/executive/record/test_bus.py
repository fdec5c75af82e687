import numpy as np
import pytest

from executive.core.types import Point, PoseEstimate, PoseSource, Segment
from executive.record.along import AlongRoute
from executive.record.bus import EventBus, harmless
from executive.record.events import SegmentEvent, WaypointEvent

ROUTE = (
    Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03, 0),
    Segment(Point(3.0, 0.0), Point(3.0, 3.0), 0.03, 0.25, 0.03, 1),
)


class Clock:
    now_s = 12.0


def at(x, y, source="markers"):

    return PoseEstimate(0.0, (x, y, 0.0), (0.0, 0.0, 0.0, 1.0), np.eye(6), source)


def test_everyone_is_told_in_turn_at_mission_time():
    told = []
    bus = EventBus(Clock(), [lambda event, time_s: told.append(("first", event, time_s))])
    bus.subscribe(lambda event, time_s: told.append(("second", event, time_s)))
    bus.publish("news")
    assert told == [("first", "news", 12.0), ("second", "news", 12.0)]


def test_only_who_looks_on_may_raise():
    def broken(event, time_s):
        raise OSError("disk full")

    EventBus(Clock(), [harmless(broken)]).publish("news")
    with pytest.raises(OSError, match="disk full"):
        EventBus(Clock(), [broken]).publish("news")


def test_progress_is_by_the_last_fix_on_the_segment_under_way():
    along = AlongRoute(ROUTE)
    assert (along.behind_m(), along.share()) == (0.0, 0.0)
    for event in (SegmentEvent(ROUTE[1]), at(3.0, 1.0), at(3.0, 2.0, PoseSource.PREDICTION)):
        along.hear(event, 0.0)
    assert along.behind_m() == pytest.approx(2.0)
    assert along.share() == pytest.approx(0.5)


def test_progress_never_leaves_the_segment():
    along = AlongRoute(ROUTE)
    for event in (SegmentEvent(ROUTE[0]), at(3.4, 0.0)):
        along.hear(event, 0.0)
    assert along.behind_m() == pytest.approx(1.0)


def test_a_way_point_reached_again_counts_once():
    along = AlongRoute(ROUTE)
    for index in (0, 1, 0):
        along.hear(WaypointEvent(index, ROUTE[0].start, at(2.0, 0.0)), 0.0)
    assert along.reached == 2
