"""The journal judges every way-point that a leaf reports, and knows which ones were reached."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from executive.core.clock import Clock
from executive.core.types import Array, Point, PoseEstimate, Reason, Segment
from executive.isc.attitude import quat_from_heading_tilt
from executive.record.bus import EventBus
from executive.record.events import LogEvent, WaypointEvent
from executive.record.journal import RunJournal

POINTS = [Point(2.0, 0.0), Point(3.0, 0.0), Point(3.0, 1.0), Point(4.0, 1.0)]
TOLERANCES = [0.05, 0.03, 0.2]
ROUTE = tuple(
    Segment(start, end, 0.03, 0.25, tolerance, index, 0.02 if index == 0 else TOLERANCES[index - 1])
    for index, ((start, end), tolerance) in enumerate(
        zip(itertools.pairwise(POINTS), TOLERANCES, strict=True)
    )
)
FINE = np.diag([1e-6] * 6)


def journal() -> tuple[RunJournal, list[object]]:
    events: list[object] = []
    return RunJournal(EventBus(Clock(1.0), [lambda event, time_s: events.append(event)]), ROUTE), events


def pose(point: Point, off_m: float = 0.0, covariance: Array = FINE) -> PoseEstimate:
    quat = quat_from_heading_tilt(0.0, 0.0, 0.0)
    return PoseEstimate(0.0, (point.x_m + off_m, point.y_m, 0.0), quat, covariance, "markers")


@pytest.mark.parametrize("reported", [s for n in range(5) for s in itertools.combinations(range(4), n)])
def test_a_mission_is_done_only_with_every_way_point(reported: tuple[int, ...]) -> None:
    book, _ = journal()
    for index in reported:
        assert book.waypoint(index, pose(POINTS[index])).ok
    missing = [str(index) for index in range(4) if index not in reported]
    missed = book.missed()
    assert (missed is None) == (not missing)
    if missed is not None:
        assert missed.startswith(f"{len(reported)} of 4 way-points were reached")
        assert not reported or missed.endswith(", ".join(missing))


@pytest.mark.parametrize(("index", "tolerance_m"), list(enumerate([0.02, *TOLERANCES])))
def test_each_way_point_is_judged_by_its_own_tolerance(index: int, tolerance_m: float) -> None:
    book, events = journal()
    assert book.waypoint(index, pose(POINTS[index], 1.05 * tolerance_m)).reason is Reason.UNEXPECTED
    assert [type(event) for event in events] == [LogEvent]
    assert book.waypoint(index, pose(POINTS[index], 0.8 * tolerance_m)).ok
    assert [type(event) for event in events] == [LogEvent, WaypointEvent]


@pytest.mark.parametrize(
    "covariance",
    [np.diag([0.04**2] * 6), np.diag([0.0] * 6), np.diag([1e-20] * 6), -FINE, np.full((6, 6), 1e-6)],
)
def test_no_way_point_is_reached_by_an_estimate_that_cannot_carry_it(covariance: Array) -> None:
    book, _ = journal()
    spoilt = covariance.copy()
    if covariance[0, 1]:
        spoilt[0, 0] = 0.0
    assert book.waypoint(2, pose(POINTS[2], 0.0, spoilt)).reason is Reason.ARRIVAL_UNCERTAIN
    assert book.missed() == "0 of 4 way-points were reached"


def test_a_way_point_reported_twice_counts_once() -> None:
    book, _ = journal()
    for _ in range(2):
        book.waypoint(1, pose(POINTS[1]))
    assert book.missed() == "1 of 4 way-points were reached; not way-points 0, 2, 3"
