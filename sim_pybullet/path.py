"""Places along the planned path."""

from __future__ import annotations

import math

from executive.core.types import Segment, Vec2

AT_A_CORNER_M = 0.05  # this near the end of a segment, the next one is the one ahead


def ahead_on(route: tuple[Segment, ...], at_m: Vec2, ahead_m: float, aside_m: float = 0.0) -> Vec2:
    """The point `ahead_m` further along the route than its place nearest to `at_m`, `aside_m` to its left.

    Beyond the end of the route its last segment goes on.
    """
    along = [min(max(s.offset(*at_m).along_m, 0.0), s.length_m) for s in route]
    away = [math.dist(at_m, _point(s, a, 0.0)) for s, a in zip(route, along, strict=True)]
    index = max(i for i, d in enumerate(away) if d <= min(away) + AT_A_CORNER_M)
    rest_m = along[index] + ahead_m
    while index < len(route) - 1 and rest_m > route[index].length_m:
        rest_m -= route[index].length_m
        index += 1
    return _point(route[index], rest_m, aside_m)


def _point(segment: Segment, along_m: float, aside_m: float) -> Vec2:
    c, s = math.cos(segment.bearing_rad), math.sin(segment.bearing_rad)
    return segment.start.x_m + c * along_m - s * aside_m, segment.start.y_m + s * along_m + c * aside_m
