"""The rungs that a search for the markers climbs: wider and wider, then elsewhere."""

from __future__ import annotations

import math
from dataclasses import dataclass

from executive.core.types import Vec2
from perception.markers.detector import SearchScope


@dataclass(frozen=True)
class Try:
    """One rung of the search: how wide to look, and where to besides the prediction (pan, tilt)."""

    scope: SearchScope
    offset_rad: Vec2 = (0.0, 0.0)


_STEP_RAD = math.radians(8.0)  # of the search pattern: a third of the field of view
_SEARCH = tuple(
    Try(SearchScope(None), (pan * _STEP_RAD, tilt * _STEP_RAD))
    for pan, tilt in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))
)
LADDER = (Try(SearchScope(1.0)), Try(SearchScope(2.5, 2.0)), Try(SearchScope(None)), *_SEARCH)
FULL_FRAMES = 2  # the rung from which on windows hide nothing
