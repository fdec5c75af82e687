"""The localizer: points the head, chooses windows and pairs, takes, detects, checks, estimates, gates.

It either returns a pose whose residuals and place are plausible, or a reason; never a guess.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from executive.clock import Clock
from executive.ports import Action, Devices, LocaliseRequest
from executive.rig import RigCalibration
from executive.types import (
    LEFT,
    RIGHT,
    Centres,
    Images,
    Outcome,
    PoseEstimate,
    Quality,
    Reason,
    Shot,
    Source,
    Vec2,
)
from executive.types import View as Seen
from perception.body import plc_in_body
from perception.chain import Chain, body_transform
from perception.exposure import View, view_of
from perception.follow_up import pointing_at
from perception.head_watch import HeadWatch, surprising
from perception.joint import JointFix
from perception.localisation import Localisation, empty
from perception.plausibility import Choice, Rejection
from perception.pose import Fix
from perception.prediction import Expectation, expect
from perception.rotation import quat_from_matrix
from perception.routine import Routine, Steps, wait_for
from perception.sight import Eyes, Scope, Sight
from perception.trend import CADENCE_S, LEDS, coarse_pose, window_margin_px

_REPOINT_RAD = math.radians(1.0)


@dataclass(frozen=True)
class Try:
    """One rung of the search: how wide to look, and where to besides the prediction."""

    scope: Scope
    pan_offset_rad: float = 0.0
    tilt_offset_rad: float = 0.0


_STEP_RAD = math.radians(8.0)  # of the search pattern: a third of the field of view
_SEARCH = tuple(
    Try(Scope(None), pan * _STEP_RAD, tilt * _STEP_RAD)
    for pan, tilt in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))
)
LADDER = (Try(Scope(1.0)), Try(Scope(2.5, 2.0)), Try(Scope(None)), *_SEARCH)
FULL_FRAMES = 2  # the rung from which on windows hide nothing


class LedStereoLocalizer:
    """Implements executive.ports.Localizer with LED difference images and a stereo pair."""

    def __init__(self, devices: Devices, rig: RigCalibration, clock: Clock) -> None:
        self._devices, self._rig, self._clock = devices, rig, clock
        self._chain = Chain.of(rig)
        self._eyes = Eyes(devices, rig, clock)
        self._watch = HeadWatch(devices, self._chain, clock)
        self.last: Localisation | None = None

    def locate(self, request: LocaliseRequest) -> Action[PoseEstimate]:
        """Measure the rover's pose; see executive.ports.Localizer."""
        deadline = self._clock.now_s + request.budget_s
        if request.quality is Quality.TREND:
            return Routine(self._tendency(request, deadline))
        return Routine(self._watched_fix(request, deadline))

    def views(self) -> tuple[Seen, ...]:
        """What the last look showed; see executive.ports.Localizer."""
        last = self.last
        if last is None or last.windows is None or last.reference is None:
            return ()
        return tuple(
            Seen(last.windows[k], last.reference[k], last.detected_px[k], last.reprojected_px[k])
            for k in (LEFT, RIGHT)
        )

    def pointing(self, pose: PoseEstimate) -> Vec2:
        """Pan and tilt [rad] that put the marker plate of this pose in the stereoscopic middle."""
        cabin = self._devices.cabin.read()
        plc = body_transform(pose) @ plc_in_body(self._rig.cabin, cabin.arm_rad, cabin.cabin_rad)
        return pointing_at(self._chain, plc.apply(self._chain.markers_plc_m).mean(axis=0))

    # -- the head, before and after a fix

    def _watched_fix(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """A fix by a head that was found well lately, and again where the fix does not fit."""
        wrong: str | None = None
        if self._watch.due:
            wrong = yield from self._watch.look(request.predicted, deadline)
            if wrong is not None:
                return Outcome(Reason.MISALIGNED, wrong)
        self._watch.note, looked = "", self._watch.note
        outcome = yield from self._fix(request, deadline)
        if not looked and _doubtful(outcome, request.predicted):
            wrong = yield from self._watch.look(request.predicted, deadline)
            looked = self._watch.note
        if wrong is not None:
            return Outcome(Reason.MISALIGNED, wrong)
        return replace(outcome, detail="; ".join(filter(None, (outcome.detail, looked))))

    # -- active markers, at rest

    def _fix(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """Climb the ladder until a plausible fix, the budget's end, or the ladder's."""
        why, retaken, rung = "no time for a single look", False, 0
        while rung < len(LADDER):
            turned = yield from self._turn_head(request, LADDER[rung], deadline)
            if turned is not None:
                return turned
            expectation = self._expectation(request.predicted)
            sight = yield from self._eyes.look(expectation, LADDER[rung].scope, request.quality, deadline)
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
            if reason is Reason.NOT_SEEN or (reason is Reason.IMPLAUSIBLE and cut_off):
                rung += 1
            elif retaken:
                value = None if isinstance(answer, Rejection) else self._estimate(sight.data, answer)
                return Outcome(reason, why, value)
            else:
                retaken = True
        return self._not_seen(request, why)

    def _turn_head(
        self, request: LocaliseRequest, rung: Try, deadline: float
    ) -> Steps[Outcome[PoseEstimate] | None]:
        """Bring the prediction (plus an offset) to the stereoscopic middle; an outcome if that failed."""
        pan, tilt = self.pointing(request.predicted)
        pan, tilt = self._clip(pan + rung.pan_offset_rad, tilt + rung.tilt_offset_rad)
        now = self._devices.head.read()
        off = max(abs(math.remainder(pan - now.pan_rad, 2 * math.pi)), abs(tilt - now.tilt_rad))
        if off <= _REPOINT_RAD and not now.moving:
            return None
        turned = yield from wait_for(self._devices.head.point(pan, tilt), self._clock, deadline)
        return None if turned.ok else Outcome(turned.reason, f"head: {turned.detail}")

    def _clip(self, pan: float, tilt: float) -> Vec2:
        head = self._rig.head
        pan = math.remainder(pan, 2 * math.pi)
        low, high = head.tilt_limits_rad
        return min(max(pan, -head.pan_limit_rad), head.pan_limit_rad), min(max(tilt, low), high)

    def _expectation(self, predicted: PoseEstimate) -> Expectation:
        head, cabin = self._devices.head.read(), self._devices.cabin.read()
        tilt = self._devices.inclinometer.read()
        return expect(
            self._chain,
            predicted,
            (head.pan_rad, head.tilt_rad),
            (cabin.arm_rad, cabin.cabin_rad),
            (tilt.roll_rad, tilt.pitch_rad),
        )

    def _judge(self, expectation: Expectation, sight: Sight) -> tuple[Reason, str] | None:
        """What speaks against this sight; None if nothing does."""
        problem: tuple[Reason, str] | None = None
        answer = sight.answer
        if sight.problem:
            problem = Reason.UNSTABLE_IMAGES, sight.problem
        elif isinstance(answer, Rejection):
            problem = (Reason.NOT_SEEN if answer.seen < 2 else Reason.IMPLAUSIBLE), answer.why
        elif misfit := expectation.misfit(answer.fix):
            problem = Reason.IMPLAUSIBLE, misfit
        if problem is not None and self.last is not None:
            self.last = replace(self.last, why=problem[1])
        return problem

    def _not_seen(self, request: LocaliseRequest, why: str) -> Outcome[PoseEstimate]:
        """POOR_VIEW where the prediction explains that nothing was seen, NOT_SEEN otherwise."""
        expectation = self._expectation(request.predicted)
        view = view_of(self._chain, expectation.state)
        pairs, most = self._eyes.most_pairs(expectation, request.quality)
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

    # -- motion fragments, while moving

    def _tendency(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """Two frames, fragments, a coarse pose."""
        turned = yield from self._turn_head(request, Try(Scope(1.0)), deadline)
        if turned is not None:
            return turned
        expectation = self._expectation(request.predicted)
        range_m = view_of(self._chain, expectation.state).range_m
        windows = self._eyes.windows(expectation, 1.0, window_margin_px(self._rig, range_m))
        shot = Shot(LEDS, windows, CADENCE_S)
        start_s = self._clock.now_s
        taken = yield from wait_for(self._devices.cameras.take(shot), self._clock, deadline)
        if taken.value is None or not taken.ok:
            return Outcome(taken.reason, f"cameras: {taken.detail}")
        pose = coarse_pose(self._chain, expectation, request.predicted, taken.value, start_s)
        why = "" if pose is not None else "nothing moved between two frames"
        self.last = empty(
            taken.value.time_s, request.quality, len(self._chain.markers_plc_m), taken.value, 0, why
        )
        return Outcome(Reason.NOT_SEEN, why) if pose is None else Outcome(Reason.DONE, value=pose)


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
