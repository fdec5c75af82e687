"""The localizer: points the head, chooses windows and pairs, takes, detects, checks, estimates, gates.

It either returns a pose whose residuals and place are plausible, or a reason; never a guess.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from executive.core.clock import Clock
from executive.core.devices import CAMERAS
from executive.core.ports import Action, Devices, LocaliseRequest
from executive.core.rig import RigCalibration
from executive.core.types import (
    LEFT,
    RIGHT,
    Centres,
    Images,
    Outcome,
    PoseEstimate,
    Quality,
    Reason,
    Source,
    Vec2,
)
from executive.core.types import View as Seen
from perception.frames.checked_cameras import CheckedCameras
from perception.frames.exposure import View, view_of
from perception.frames.routine import Routine, Steps
from perception.geometry.chain import Chain
from perception.geometry.pose import Fix
from perception.geometry.prediction import Expectation
from perception.geometry.rotation import quat_from_matrix
from perception.head.head_watch import HeadWatch, surprising
from perception.localizer.aim import Aim
from perception.localizer.counting_cameras import Tally
from perception.localizer.empty_views import EmptyViews
from perception.localizer.localisation import Localisation, empty
from perception.localizer.outlines import Found, Outlines
from perception.localizer.scouting import Scout
from perception.localizer.tendency import Tendency
from perception.localizer.warm_up import warm_up
from perception.markers.choice import Choice, JointFix, Rejection
from perception.markers.detector import Eyes, Sight
from perception.markers.ladder import FULL_FRAMES, LADDER


class LedStereoLocalizer:
    """Implements executive.core.ports.Localizer with LED difference images and a stereo pair."""

    def __init__(self, devices: Devices, rig: RigCalibration, clock: Clock) -> None:
        self._clock = clock
        self._chain = Chain.of(rig)
        self._tally = Tally(CheckedCameras(devices[CAMERAS], rig.sensor), clock)
        devices = devices.replace(CAMERAS, self._tally)
        self._aim = Aim(devices, self._chain, clock)
        self._eyes = Eyes(devices, rig, clock)
        self._tendency = Tendency(devices, self._chain, clock, self._aim, self._eyes)
        self._watch = HeadWatch(devices, self._chain, clock)
        views = EmptyViews(self._chain)
        self._scout = Scout(devices, self._chain, clock, self._aim, views)
        self._outlines = Outlines(devices, self._chain, clock, self._aim, views)
        self.last: Localisation | None = None

    @staticmethod
    def expected_markers(rig: RigCalibration) -> int:
        """All of them."""
        return len(rig.markers.positions_plc_m)

    @staticmethod
    def preload() -> None:
        """What processes that fork from this one would each do anew; see executive.core.ports.Localizer."""
        warm_up()

    def locate(self, request: LocaliseRequest) -> Action[PoseEstimate]:
        """Measure the rover's pose; see executive.core.ports.Localizer."""
        deadline = self._clock.now_s + request.budget_s
        if request.quality is Quality.TREND:
            return Routine(self._moving(request, deadline))
        return Routine(self._accounted(request, deadline))

    def views(self) -> tuple[Seen, ...]:
        """What the last look showed; see executive.core.ports.Localizer."""
        last = self.last
        if last is None or last.windows is None or last.reference is None:
            return ()
        return tuple(
            Seen(last.windows[k], last.reference[k], last.detected_px[k], last.reprojected_px[k])
            for k in (LEFT, RIGHT)
        )

    def pointing(self, pose: PoseEstimate) -> Vec2:
        """Pan and tilt [rad] that put the marker plate of this pose in the stereoscopic middle."""
        return self._aim.pointing(pose)

    def _moving(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """A tendency, and what it looked at."""
        outcome = yield from self._tendency.measure(request, deadline)
        self.last = self._tendency.last or self.last
        return outcome

    def _accounted(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """A fix, or none, with what it cost."""
        self._tally.begin()
        outcome = yield from self._watched_fix(request, deadline)
        if self.last is not None:
            self.last = replace(self.last, frames=self._tally.frames, took_s=self._tally.took_s)
        return replace(outcome, detail="; ".join(filter(None, (outcome.detail, self._tally.told()))))

    # -- the head, before and after a fix

    def _watched_fix(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """A fix by a head that was found well lately, and again where the fix does not fit."""
        wrong: str | None = None
        if self._watch.due:
            wrong = yield from self._watch.look(request.predicted, deadline)
            if wrong is not None:
                return Outcome(Reason.MISALIGNED, wrong)
        self._watch.note, looked = "", self._watch.note
        yield from self._scout.look_ahead(request, deadline)
        outcome = yield from self._fix(request, deadline)
        if not looked and _doubtful(outcome, request.predicted):
            wrong = yield from self._watch.look(request.predicted, deadline)
            looked = self._watch.note
        if wrong is not None:
            return Outcome(Reason.MISALIGNED, wrong)
        return replace(outcome, detail="; ".join(filter(None, (outcome.detail, looked))))

    # -- active markers, at rest

    def _fix(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """Climb the ladder until a plausible fix, the budget's end, or the ladder's.

        Where the first rung shows no marker, the outline is asked before the search goes on.
        """
        why, outline, retaken, rung = "no time for a single look", "", False, 0
        while rung < len(LADDER):
            turned = yield from self._aim.turn_to(request.predicted, LADDER[rung].offset_rad, deadline)
            if turned is not None:
                return turned
            expectation = self._aim.expectation(request.predicted)
            sight = yield from self._eyes.look(expectation, LADDER[rung].scope, request, deadline)
            if sight is None:
                break
            if isinstance(sight, Outcome):
                return Outcome(sight.reason, sight.detail)
            answer = sight.answer
            self._keep(request.quality, sight)
            problem = self._judge(expectation, sight)
            if problem is None and not isinstance(answer, Rejection):
                return Outcome(Reason.DONE, _cost(sight), self._estimate(sight.data, answer))
            reason, why = problem or (Reason.NOT_SEEN, "")
            cut_off = isinstance(answer, Rejection) and rung < FULL_FRAMES  # a window may cut markers off
            if reason is Reason.NOT_SEEN and not outline:
                found = yield from self._outlines.find(request.predicted, deadline)
                if isinstance(found, Found):
                    return self._by_outline(request.quality, found, why)
                outline = found
            if reason is Reason.NOT_SEEN or (reason is Reason.IMPLAUSIBLE and cut_off):
                rung += 1
            elif retaken:
                value = None if isinstance(answer, Rejection) else self._estimate(sight.data, answer)
                return Outcome(reason, why, value)
            else:
                retaken = True
        return self._not_seen(request, "; ".join(filter(None, (why, outline))))

    def _by_outline(self, quality: Quality, found: Found, why: str) -> Outcome[PoseEstimate]:
        self.last = empty(found.data.time_s, quality, len(self._chain.markers_plc_m), found.data, 0, "")
        if isinstance(found.data, Images):
            left, right = (counts.mean(axis=0, dtype=np.float32) for counts in found.data.counts)
            self.last = replace(self.last, reference=(left, right))
        return Outcome(Reason.DONE, f"{found.note}; as {why}", found.pose)

    def _judge(self, expectation: Expectation, sight: Sight) -> tuple[Reason, str] | None:
        """What speaks against this sight; None if nothing does."""
        problem: tuple[Reason, str] | None = None
        answer = sight.answer
        if sight.problem:
            problem = Reason.UNSTABLE_IMAGES, sight.problem
        elif isinstance(answer, Rejection):
            problem = (Reason.NOT_SEEN if answer.seen < 2 else Reason.IMPLAUSIBLE), answer.why
        elif misfit := expectation.misfit(answer.fix.state.site_body, answer.fix.covariance):
            problem = Reason.IMPLAUSIBLE, misfit
        if problem is not None and self.last is not None:
            self.last = replace(self.last, why=problem[1])
        return problem

    def _not_seen(self, request: LocaliseRequest, why: str) -> Outcome[PoseEstimate]:
        """POOR_VIEW where the prediction explains that nothing was seen, NOT_SEEN otherwise."""
        expectation = self._aim.expectation(request.predicted)
        view = view_of(self._chain, expectation.state)
        pairs, most = self._eyes.most_pairs(expectation, request)
        if view.cosine <= 0 or pairs > most:
            return Outcome(Reason.POOR_VIEW, f"{why}; {_describe(view, pairs)}, at most {most}")
        return Outcome(Reason.NOT_SEEN, f"{why}; {_describe(view, pairs)}")

    def _estimate(self, data: Images | Centres, answer: Choice | JointFix) -> PoseEstimate:
        body = answer.fix.state.site_body
        x, y, z = body.position_m.tolist()
        return PoseEstimate(
            time_s=data.time_s,
            position_site_m=(x, y, z),
            quat_site_body=quat_from_matrix(body.rotation),
            covariance=answer.fix.covariance,
            source=Source.MARKERS,
            markers=answer.markers,
        )

    def _keep(self, quality: Quality, sight: Sight) -> None:
        data, answer = sight.data, sight.answer
        blank = empty(data.time_s, quality, len(self._chain.markers_plc_m), data, sight.pairs, "")
        self.last = replace(blank, reference=sight.reference, detected_px=sight.detected_px)
        if not isinstance(answer, Rejection):
            fix: Fix = answer.fix
            self.last = replace(
                self.last,
                reprojected_px=fix.reprojected_px,
                residual_px=fix.residual_px,
                chi2=fix.chi2,
                dof=fix.dof,
            )


def _doubtful(outcome: Outcome[PoseEstimate], predicted: PoseEstimate) -> bool:
    """Whether an outcome might be the head's fault."""
    if outcome.ok and outcome.value is not None:
        return surprising(outcome.value, predicted)
    return outcome.reason in (Reason.IMPLAUSIBLE, Reason.NOT_SEEN)


def _cost(sight: Sight) -> str:
    took_s = sight.frames * sight.data.shot.cadence_s
    note = "" if isinstance(sight.answer, Rejection) or not sight.answer.note else f"; {sight.answer.note}"
    return f"{sight.pairs} pairs, {sight.frames} frames in {took_s:.0f} s{note}"


def _describe(view: View, pairs: float) -> str:
    angle = math.degrees(math.acos(max(-1.0, min(1.0, view.cosine))))
    return (
        f"expected at {view.range_m:.1f} m, {angle:.0f} deg off the plate's normal, "
        f"{pairs:.0f} pairs to see it"
    )
