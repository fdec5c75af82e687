"""Looks at the ground ahead before the rover drives there, so that it can be known again by its outline."""

from __future__ import annotations

import math

import numpy as np

from executive.core.clock import Clock
from executive.core.devices import CAMERAS
from executive.core.ports import Devices, LocaliseRequest
from executive.core.types import (
    Array,
    Images,
    PoseEstimate,
    Segment,
    Shot,
    Vec2,
)
from perception.frames.routine import Steps, wait_for
from perception.frames.shots import overexposed
from perception.geometry.chain import Chain
from perception.geometry.follow_up import pointing_at
from perception.localizer.aim import Aim
from perception.localizer.empty_views import EmptyView, EmptyViews

FRAMES = 8
"""Without any LED lit; their mean is hardly noisier than the ground's own likeness between two pointings."""
UNLIT = (0,) * FRAMES
AHEAD_M = 4.0
_SPACING_M = 0.15
_AROUND_M = (0.4, 0.8)  # the end of a segment
_ROUND = 8
_BEARINGS_RAD = np.arange(_ROUND) * 2 * math.pi / _ROUND
_LOOK_S = 120.0  # left of a budget, it does for scouting and still for a fix
_AGAIN_S = 600.0  # after a look that failed
_MOST_AT_ONCE = 4  # looks, some eight seconds each
_SURE_M = 0.10  # a rover whose own place is known no better than this hides unknown ground


class Scout:
    """Takes the views that the way ahead still lacks."""

    def __init__(self, devices: Devices, chain: Chain, clock: Clock, aim: Aim, views: EmptyViews) -> None:
        self._devices, self._chain, self._clock = devices, chain, clock
        self._aim, self._views = aim, views
        self._not_before_s = 0.0

    def look_ahead(self, request: LocaliseRequest, deadline_s: float) -> Steps[None]:
        """Look along the segment under way at what no view shows yet and the rover does not hide."""
        rover, segment = request.predicted, request.segment
        if segment is None or rover.sigma_position_m > _SURE_M or self._clock.now_s < self._not_before_s:
            return
        places = places_ahead(rover, segment)
        for _ in range(_MOST_AT_ONCE):
            head_rad = self._next(rover, places)
            if head_rad is None or self._clock.now_s + _LOOK_S > deadline_s:
                return
            view = yield from self._view(head_rad, rover, deadline_s)
            if view is None:
                self._not_before_s = self._clock.now_s + _AGAIN_S
                return
            self._views.add(view)

    def _next(self, rover: PoseEstimate, places: Array) -> Vec2 | None:
        """Where the head finds the nearest place that no view shows, and as many after it as it can."""
        for index in np.flatnonzero(self._views.missing(places)):
            best: Vec2 | None = None
            for place in places[index:]:
                head_rad = pointing_at(self._chain, place)
                if not self._would_be(head_rad, rover).shows(self._chain, places[index : index + 1])[0]:
                    break
                best = head_rad
            if best is not None:
                return best
        return None

    def _would_be(self, head_rad: Vec2, rover: PoseEstimate) -> EmptyView:
        return EmptyView.before(self._chain, self._clock.now_s, head_rad, rover.position_site_m)

    def _view(self, head_rad: Vec2, rover: PoseEstimate, deadline_s: float) -> Steps[EmptyView | None]:
        """Full frames from there, None if head or cameras failed or the frames are of no use."""
        failed = yield from self._aim.turn(head_rad, deadline_s)
        if failed is not None:
            return None
        taken = yield from wait_for(self._devices[CAMERAS].take(Shot(UNLIT)), self._clock, deadline_s)
        if taken.value is None or not taken.ok:
            return None
        data, sensor = taken.value, self._chain.rig.sensor
        if overexposed(data, sensor):
            return None
        view = self._would_be((data.head.pan_rad, data.head.tilt_rad), rover)
        return view.of(data) if isinstance(data, Images) else view


def places_ahead(rover: PoseEstimate, segment: Segment) -> Array:
    """Places (n, 3) in site from the rover to the segment's end and around that, whichever way it goes on,
    on ground as high as here [m]."""
    way = segment.offset(rover.x_m, rover.y_m)
    length_m = min(way.remaining_m, AHEAD_M)
    along_m = np.append(np.arange(0.0, length_m, _SPACING_M), length_m)
    bearing_rad = np.full(len(along_m), way.bearing_to_end_rad)
    line = _polar(along_m, bearing_rad)
    around = np.concatenate([_polar(np.full(_ROUND, r), _BEARINGS_RAD) for r in _AROUND_M])
    places: Array = np.array(rover.position_site_m) + np.concatenate([line, line[-1] + around])
    return places


def _polar(distance_m: Array, bearing_rad: Array) -> Array:
    """Horizontal vectors (n, 3) in site."""
    level = np.stack([np.cos(bearing_rad), np.sin(bearing_rad), np.zeros(len(bearing_rad))], axis=1)
    return np.asarray(distance_m[:, None] * level)
