"""The localizer: a tendency while the rover moves, or a fix at rest by a head that is checked.

It either returns a pose whose residuals and place are plausible, or a reason; never a guess.
"""

from __future__ import annotations

from dataclasses import replace

from executive.core.clock import Clock
from executive.core.devices import CAMERAS
from executive.core.ports import Action, Devices, LocaliseRequest
from executive.core.rig import RigCalibration
from executive.core.types import (
    Localisation,
    Outcome,
    PoseEstimate,
    Quality,
    Reason,
    Vec2,
)
from perception.frames.checked_cameras import CheckedCameras
from perception.frames.routine import Routine, Steps
from perception.geometry.chain import Chain
from perception.head.head_watch import HeadWatch, surprising
from perception.localizer.aim import Aim
from perception.localizer.counting_cameras import CountingCameras
from perception.localizer.empty_views import EmptyViews
from perception.localizer.fix_search import FixSearch
from perception.localizer.outlines import Outlines
from perception.localizer.scouting import Scout
from perception.localizer.spec import LedStereoSettings
from perception.localizer.tendency import Tendency
from perception.markers.detector import MarkerDetector


class LedStereoLocalizer:
    """Implements executive.core.ports.Localizer with LED difference images and a stereo pair."""

    def __init__(
        self,
        devices: Devices,
        rig: RigCalibration,
        clock: Clock,
        settings: LedStereoSettings | None = None,
    ) -> None:
        self._clock, self._settings = clock, settings or LedStereoSettings()
        chain = Chain.of(rig)
        self._cameras = CountingCameras(CheckedCameras(devices[CAMERAS], rig.sensor), clock)
        devices = devices.replace(CAMERAS, self._cameras)
        self._aim = Aim(devices, chain, clock)
        detector = MarkerDetector(devices, rig, clock)
        views = EmptyViews(chain)
        self._tendency = Tendency(devices, chain, clock, self._aim, detector)
        self._watch = HeadWatch(devices, chain, clock)
        self._scout = Scout(devices, chain, clock, self._aim, views)
        outlines = Outlines(devices, chain, clock, self._aim, views) if self._settings.outlines else None
        self._search = FixSearch(chain, self._aim, detector, outlines)

    def locate(self, request: LocaliseRequest) -> Action[Localisation]:
        """Measure the rover's pose; see executive.core.ports.Localizer."""
        deadline_s = self._clock.now_s + request.budget_s
        if request.quality is Quality.TREND:
            return Routine(self._tendency.measure(request, deadline_s))
        return Routine(self._counted_fix(request, deadline_s))

    def pointing(self, pose: PoseEstimate) -> Vec2:
        """Pan and tilt [rad] that put the marker plate of this pose in the stereoscopic middle."""
        return self._aim.pointing(pose)

    def _counted_fix(self, request: LocaliseRequest, deadline_s: float) -> Steps[Outcome[Localisation]]:
        """A fix, or none, with what it cost."""
        self._cameras.begin()
        outcome = yield from self._watched_fix(request, deadline_s)
        return _with_note(outcome, self._cameras.cost)

    def _watched_fix(self, request: LocaliseRequest, deadline_s: float) -> Steps[Outcome[Localisation]]:
        """A fix by a head that was found well lately, and is checked again where the fix does not fit."""
        wrong: str | None = None
        if self._settings.watch_head and self._watch.due:
            wrong = yield from self._watch.look(request.predicted, deadline_s)
            if wrong is not None:
                return Outcome(Reason.MISALIGNED, wrong)
        self._watch.note, note = "", self._watch.note
        if self._settings.outlines:
            yield from self._scout.look_ahead(request, deadline_s)
        outcome = yield from self._search.fix(request, deadline_s)
        if self._settings.watch_head and not note and _doubtful(outcome, request.predicted):
            wrong = yield from self._watch.look(request.predicted, deadline_s)
            note = self._watch.note
        if wrong is not None:
            views = () if outcome.value is None else outcome.value.views
            return Outcome(Reason.MISALIGNED, wrong, Localisation(None, views))
        return _with_note(outcome, note)


def _with_note(outcome: Outcome[Localisation], note: str) -> Outcome[Localisation]:
    return replace(outcome, detail="; ".join(filter(None, (outcome.detail, note))))


def _doubtful(outcome: Outcome[Localisation], predicted: PoseEstimate) -> bool:
    """Whether an outcome might be the head's fault."""
    if outcome.ok and outcome.value is not None and outcome.value.pose is not None:
        return surprising(outcome.value.pose, predicted)
    return outcome.reason in (Reason.IMPLAUSIBLE, Reason.NOT_SEEN)
