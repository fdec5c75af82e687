"""What truth says of a run as it went on: the measures that limits are set to, each over mission time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from executive.core.types import Array
from executive.record import History, JudgedRow, row
from executive.record.events import (
    SegmentEvent,
    Start,
    Stop,
    Telemetry,
)
from executive.record.truth import (
    CrossTrack,
    Track,
    cross_track,
    driven_beyond_m,
)

NO_TRUTH = "no truth was recorded"
REST_M_S = 1e-4
"""Slower than this is at rest: a fourteenth of the rover's speed, and what settling into sand may take."""


@dataclass(frozen=True)
class Measure:
    """One measure of every true sample, shape (n,), and the unit it is given in."""

    unit: str
    of: Callable[[Track, CrossTrack], Array]


DRIVEN_BEYOND = Measure("m", driven_beyond_m)
CROSS_TRACK = Measure("m", lambda track, cross: np.abs(cross.cross_m))
TILT = Measure("deg", lambda track, cross: np.degrees(track.tilt_rad()))
TETHER = Measure("N", lambda track, cross: track.tether_n)


def below(text: str, measure: Measure, limit: float, history: History, world: History) -> JudgedRow:
    """Whether a measure stayed below a limit, both in its unit; unknown (None) without truth."""
    track = Track.of(world)
    if track is None:
        return row(text, None, warning=NO_TRUTH)
    values = measure.of(track, cross_track(track, history.all(SegmentEvent)))
    known = np.isfinite(values)
    if not known.any():
        return row(text, True, warning="vacuous: it was never defined")
    reached = known & (values >= limit)
    since_s = float(track.time_s[reached.argmax()]) if reached.any() else None
    return row(text, since_s is None, limit - float(values[known].max()), measure.unit, since_s)


def at_rest(history: History, world: History) -> JudgedRow:
    """Whether the rover stood still in the last tick, by truth and by what the tracks reported.

    Unknown (None) where the record breaks off, as of a killed process: nobody saw the end of that drive.
    """
    told, track = history.last(Telemetry), Track.of(world)
    if told is None and track is None:
        return row("at rest at the end", None, warning="neither truth nor telemetry was recorded")
    if history.last(Stop) is None:
        return row("at rest at the end", None, warning="the record ends without a stop")
    moving = told is not None and told.event.moving
    speed_m_s = 0.0 if track is None else _last_speed_m_s(track, history)
    spare_m_s = None if track is None else REST_M_S - speed_m_s
    met = speed_m_s < REST_M_S and not moving
    return row("at rest at the end", met, spare_m_s, "m/s", history.end_s)


def _last_speed_m_s(track: Track, history: History) -> float:
    start = history.last(Start)
    tick_s = start.event.tick_s if start is not None else 1.0
    way = track.position(history.end_s) - track.position(history.end_s - tick_s)
    return float(np.linalg.norm(way)) / tick_s
