"""The fallback where no marker shows: the rover's outline against ground that was seen without it.

Nothing here is taken for granted: a place that was never seen empty, a prediction that is too uncertain for
the outline's search, images that another pose would explain as well, all end as a refusal in words.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from executive.core.clock import Clock
from executive.core.devices import CAMERAS, INCLINOMETER
from executive.core.ports import Devices
from executive.core.types import (
    Array,
    CameraView,
    Centres,
    Images,
    PoseEstimate,
    Shot,
)
from perception.frames.routine import Steps, wait_for
from perception.frames.shots import saturation
from perception.frames.similarity import compare
from perception.frames.views import camera_views
from perception.geometry.body import Transform
from perception.geometry.chain import Chain, pose_estimate
from perception.geometry.prediction import Expectation
from perception.localizer.aim import Aim
from perception.localizer.empty_views import REACH_M, EmptyView, EmptyViews
from perception.localizer.scouting import UNLIT
from perception.localizer.spec import PASSIVE
from perception.markers.marker_fix import Rejection
from perception.markers.plausibility import choose
from perception.markers.single import find_candidates
from perception.outline.passive import (
    Ground,
    PassiveFix,
    PassiveRefusal,
    Sun,
    passive_fix,
)

_MOST_OFF_M, _MOST_TURNED_RAD = 0.30, math.radians(15.0)  # as far as the outline is searched for
_SIGMAS = 2.0
_VIEWS = 2  # tried
_NOWHERE = np.empty((2, 0, 2))
_SUN_KEPT_S = 1200.0  # it moves by five degrees; to find it takes as long as all the rest


@dataclass(frozen=True, eq=False)
class OutlineFix:
    """A pose and what it rests on; `data` is what was looked at."""

    pose: PoseEstimate
    note: str
    data: Images | Centres

    @property
    def views(self) -> tuple[CameraView, ...]:
        """The mean images, without any marker."""
        if isinstance(self.data, Centres):
            return ()
        left, right = (counts.mean(axis=0, dtype=np.float32) for counts in self.data.counts)
        return camera_views(self.data, (left, right), _NOWHERE, _NOWHERE)


@dataclass(frozen=True, eq=False)
class _Body:
    site_body: Transform
    covariance: Array
    note: str


class Outlines:
    """Finds the expected rover without its lights."""

    def __init__(self, devices: Devices, chain: Chain, clock: Clock, aim: Aim, views: EmptyViews) -> None:
        self._devices, self._chain, self._clock = devices, chain, clock
        self._aim, self._views = aim, views
        self._sun: tuple[float, Sun] | None = None

    def find(self, predicted: PoseEstimate, deadline_s: float) -> Steps[OutlineFix | str]:
        """The rover's pose, or why it is not known."""
        off_m, turned_rad = _SIGMAS * predicted.sigma_position_m, _SIGMAS * predicted.sigma_heading_rad
        if off_m > _MOST_OFF_M or turned_rad > _MOST_TURNED_RAD:
            return (
                f"no outline sought: the rover may be {off_m:.1f} m, {math.degrees(turned_rad):.0f} deg off"
            )
        views = self._views.of(predicted.position_site_m, REACH_M + off_m)
        why = "no outline sought: this place was not seen without the rover"
        for view in itertools.islice(views, _VIEWS):
            found = yield from self._against(view, predicted, deadline_s)
            if isinstance(found, OutlineFix):
                return found
            why = f"no outline against the view of {view.time_s:.0f} s: {found}"
        return why

    def _against(
        self, view: EmptyView, predicted: PoseEstimate, deadline_s: float
    ) -> Steps[OutlineFix | str]:
        """The head goes back to where it looked, for the same frames with the rover in them."""
        failed = yield from self._aim.turn(view.head_rad, deadline_s)
        if failed is not None:
            return failed.detail
        expectation = self._aim.expectation(predicted)
        windows = view.windows(self._chain, expectation)
        shot = Shot(UNLIT, windows)
        taken = yield from wait_for(self._devices[CAMERAS].take(shot), self._clock, deadline_s)
        if taken.value is None or not taken.ok:
            return f"cameras: {taken.detail}"
        data = taken.value
        state = replace(expectation.state, head_rad=(data.head.pan_rad, data.head.tilt_rad))
        expectation = replace(expectation, state=state)
        body = self._from_images(data, view, expectation) if isinstance(data, Images) else None
        if isinstance(data, Centres):
            body = self._from_centres(data, expectation)
        if body is None or isinstance(body, str):
            return body or "nothing to see"
        if misfit := expectation.misfit(body.site_body, body.covariance):
            return misfit
        note = f"outline against the view of {view.time_s:.0f} s, {len(UNLIT)} frames; {body.note}"
        return OutlineFix(pose_estimate(data.time_s, body.site_body, body.covariance, PASSIVE), note, data)

    def _from_images(self, data: Images, view: EmptyView, expectation: Expectation) -> _Body | str:
        sensor = self._chain.rig.sensor
        for name, counts in zip(("left", "right"), data.counts, strict=True):
            if problem := saturation(counts, sensor) or compare(counts, sensor.noise_counts).problem:
                return f"{name} camera: {problem}"
        found = self._fitted(data, view, expectation, self._last_sun())
        if isinstance(found, PassiveRefusal) and self._last_sun():
            found = self._fitted(data, view, expectation, None)
        if isinstance(found, PassiveRefusal):
            return found.why
        self._sun = (data.time_s, found.sun)
        return _Body(found.site_body, found.covariance, found.note)

    def _fitted(
        self, data: Images, view: EmptyView, expectation: Expectation, sun: Sun | None
    ) -> PassiveFix | PassiveRefusal:
        """Without a survey, the ground is held to be as high as predicted."""
        height_m, sigma_m = expectation.state.site_body.position_m[2], math.sqrt(expectation.covariance[2, 2])
        ground, empty = Ground(float(height_m), sigma_m), view.counts(data.windows)
        return passive_fix(self._chain, data.counts, empty, data.windows, expectation, ground, sun)

    def _last_sun(self) -> Sun | None:
        """Where the shadow of the last fix showed the sun, if that is not long ago."""
        if self._sun is None or self._clock.now_s > self._sun[0] + _SUN_KEPT_S:
            return None
        return self._sun[1]

    def _from_centres(self, data: Centres, expectation: Expectation) -> _Body | str:
        """The geometric tier tells an outline by where it puts the markers' places."""
        candidates = find_candidates(self._chain.rig, data, 1.0).candidates
        if not np.isfinite(data.uv_px).all():
            return "no outline shows"
        state, tilt = expectation.state, self._devices[INCLINOMETER].read()
        attitude = (tilt.roll_rad, tilt.pitch_rad)
        found = choose(self._chain, candidates, state.head_rad, state.joints_rad, attitude, expectation.prior)
        if isinstance(found, Rejection):
            return found.why
        return _Body(found.fit.state.site_body, found.fit.covariance, "as the outline's error model has it")
