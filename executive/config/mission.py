"""What makes a mission impossible although its file is well formed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from executive.config.find import shown
from executive.config.models import MissionFile, Waypoint
from executive.config.source import Place, Source, read
from executive.config.validate import parse
from executive.core.corridor import distance_m
from executive.core.errors import ConfigError, Problem
from executive.core.types import Point, Segment

NEAREST_M, FURTHEST_M = 1.2, 20.0
"""The rover works within 20 m of the lander; nearer than 1.2 m the head cannot see it with both cameras."""


def load_mission(path: Path) -> MissionFile:
    """A mission file, checked."""
    source = read(path, shown(path))
    mission = parse(source, MissionFile)
    if problems := list(mission_problems(source, (), mission)):
        raise ConfigError(problems)
    return mission


def mission_problems(source: Source, at: Place, mission: MissionFile) -> Iterator[Problem]:
    """Way-points out of reach, segments without length, margins that contradict each other."""
    points = (*at, "waypoints")
    for index, waypoint in enumerate(mission.waypoints):
        yield from _reach_problem(source, (*points, index), waypoint)
    for index, (start, end) in enumerate(pairwise(mission.waypoints), 1):
        if math.hypot(end.x - start.x, end.y - start.y) < 1e-6:
            message = f"got the same place as way-point {index - 1}, expected a segment with a length"
            yield source.at((*points, index)).problem(message)
        else:
            yield from _lander_problem(source, (*points, index), start, end)
    yield from _margin_problems(source, at, mission)
    yield from _corner_problems(source, at, mission)


def _reach_problem(source: Source, place: Place, waypoint: Waypoint) -> Iterator[Problem]:
    distance_m = math.hypot(waypoint.x, waypoint.y)
    if not NEAREST_M <= distance_m <= FURTHEST_M:
        yield source.at(place).problem(
            f"got an unreachable way-point, {distance_m:.2f} m from the lander, "
            f"expected {NEAREST_M:g} m to {FURTHEST_M:g} m"
        )


def _lander_problem(source: Source, place: Place, start: Waypoint, end: Waypoint) -> Iterator[Problem]:
    """A segment that leads nearer to the lander than either of its ends may lie."""
    nearest_m = _distance_of_origin_m(start, end)
    apart = min(math.hypot(start.x, start.y), math.hypot(end.x, end.y)) >= NEAREST_M
    if apart and nearest_m < NEAREST_M:
        yield source.at(place).problem(
            f"got a way here that passes the lander at {nearest_m:.2f} m, expected {NEAREST_M:g} m or more: "
            "put a way-point between"
        )


def _distance_of_origin_m(start: Waypoint, end: Waypoint) -> float:
    """How near the straight way between two way-points comes to the lander."""
    segment = Segment(Point(start.x, start.y), Point(end.x, end.y), 0.0, 0.0, 0.0)
    return distance_m(segment, 0.0, 0.0)


def _corner_problems(source: Source, at: Place, mission: MissionFile) -> Iterator[Problem]:
    """A tolerance in which the rover may stand beyond the margin of the segment that begins there."""
    for index in range(1, len(mission.waypoints) - 1):
        tolerance, margin = mission.margins(index).tolerance, mission.margins(index + 1).off_track
        if not tolerance <= margin:
            message = (
                f"got tolerance {tolerance:g} m where the next segment has off_track {margin:g} m, "
                "expected tolerance to be at most that: the rover may stand off the next segment's track"
            )
            yield source.at(_margin_place(source, at, index, ("tolerance",))).problem(message)


def _margin_problems(source: Source, at: Place, mission: MissionFile) -> Iterator[Problem]:
    reported = set()
    for index in range(1, len(mission.waypoints)):
        margins = mission.margins(index)
        for low, high, strict in (("on_track", "off_track", True), ("tolerance", "off_track", False)):
            small, large = getattr(margins, low), getattr(margins, high)
            if small < large or (small == large and not strict):
                continue
            place = _margin_place(source, at, index, (low, high))
            relation = "less than" if strict else "at most"
            message = f"got {low} {small:g} m with {high} {large:g} m, expected {low} to be {relation} {high}"
            if (place, message) not in reported:
                reported.add((place, message))
                yield source.at(place).problem(message)


def _margin_place(source: Source, at: Place, index: int, names: tuple[str, ...]) -> Place:
    """Where one of these margins is said: at the way-point, or among the defaults."""
    for scope in ((*at, "waypoints", index), (*at, "segments")):
        for name in names:
            if (*scope, name) in source.values:
                return (*scope, name)
    return (*at, "waypoints", index)
