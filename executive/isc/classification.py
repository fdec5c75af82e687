"""In-situ classification: predict, compare, weigh hypotheses, extrapolate (paper, section 3.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from executive.core.clock import Clock
from executive.core.ordered_sum import ordered_sum
from executive.core.rig import Rig
from executive.core.types import Outcome, PoseEstimate, Reason, Segment
from executive.isc import correction
from executive.isc.assessment import Assessment
from executive.isc.bank import Evidence, HypothesisBank
from executive.isc.comparison import Comparison, Innovation
from executive.isc.extrapolation import time_to_margin_s
from executive.isc.motion import MotionNoise, MotionState
from executive.isc.specs import Channel, Concern, Hypothesis
from executive.isc.tracker import Tracker


def nobody_listens(assessment: Assessment) -> None:
    """The `announce` of a classification whose assessments nobody records."""


class Classification:
    """Weighs the hypotheses it is given by the channels it is given, at every fix and failure.

    `announce` hears every assessment that a fix, a failure or an extrapolation leads to. `markers_expected`
    is how many markers a fix of this localizer should rest on, 0 where it uses none.
    """

    def __init__(
        self,
        prior: PoseEstimate,
        rig: Rig,
        clock: Clock,
        hypotheses: Iterable[Hypothesis],
        channels: Iterable[Channel],
        announce: Callable[[Assessment], None] = nobody_listens,
        markers_expected: int = 0,
        noise: MotionNoise | None = None,
    ) -> None:
        self.bank = HypothesisBank(hypotheses, channels)
        self.tracker = Tracker(prior, rig, clock, noise or MotionNoise())
        self.weights: dict[str, float] = dict(self.bank.prior)
        self.evidence: Evidence | None = None
        self.observed_turn_ratio: float | None = None
        self.observed_advance_ratio: float | None = None
        self._speed_m_s, self._clock, self._announce = rig.rover.speed_m_s, clock, announce
        self._markers_expected = markers_expected
        self._usual_current_a: float | None = None

    @property
    def motion(self) -> MotionState:
        """The motion model: pose and soil."""
        return self.tracker.motion

    def predicted(self) -> PoseEstimate:
        """Where the rover should be now."""
        return self.motion.pose()

    def fuse(self, fix: PoseEstimate) -> PoseEstimate:
        """The fix just taken in, fused with what was predicted."""
        return correction.fuse(self.motion, fix)

    def on_fix(self, fix: PoseEstimate) -> Assessment:
        """Compare a precise fix with the prediction, weigh, and learn if the fix is explained."""
        comparison = self._comparison(fix)
        turn, advance = comparison.turn_ratio, comparison.advance_ratio
        self.observed_turn_ratio = None if turn is None else turn.value
        self.observed_advance_ratio = None if advance is None else advance.value
        self._weigh(comparison)
        if self.tracker.inflated:  # measured again: a false fix would not have repeated itself
            self.weights = self.bank.without(self.weights, Concern.FIX)
        as_predicted = (w for name, w in self.weights.items() if self.bank.moves_as_predicted(name))
        explained = ordered_sum(as_predicted) > 0.5
        if explained:
            self._remember_current()
        self.tracker.take_in(fix, explained)
        return self._assessed()

    def on_failure(self, outcome: Outcome[object]) -> Assessment:
        """Weigh the reason of a failure; a blocked drive inflates what was predicted since the last fix."""
        if outcome.reason is Reason.BLOCKED:
            self.tracker.on_blocked()
        self._weigh(
            Comparison(
                time_s=self._clock.now_s,
                motion=self.motion,
                failure=outcome.reason,
                detail=outcome.detail,
                readings=self.tracker.readings,
            )
        )
        return self._assessed()

    def assess(self) -> Assessment:
        """The present weights."""
        return Assessment(self._clock.now_s, dict(self.weights), evidence=self.evidence)

    def extrapolate(self, pose: PoseEstimate, segment: Segment | None) -> Assessment:
        """The present weights and where this leads on `segment`, announced."""
        speed_m_s = self._speed_m_s * self.motion.advance
        return self._assessed(None if segment is None else time_to_margin_s(pose, segment, speed_m_s))

    def settle(self) -> None:
        """Return the hypotheses to their prior: the last anomaly has been dealt with."""
        self.weights = dict(self.bank.prior)

    def _assessed(self, time_to_margin_s: float | None = None) -> Assessment:
        assessment = replace(self.assess(), time_to_margin_s=time_to_margin_s)
        self._announce(assessment)
        return assessment

    def _comparison(self, fix: PoseEstimate) -> Comparison:
        return Comparison(
            time_s=self._clock.now_s,
            motion=self.tracker.judging,
            fix=fix,
            innovation=Innovation.of(self.tracker.judging, fix),
            since=self.tracker.since,
            readings=self.tracker.readings,
            usual_current_a=self._usual_current_a,
            markers_expected=self._markers_expected,
        )

    def _weigh(self, comparison: Comparison) -> None:
        self.evidence = self.bank.observe(comparison)
        self.weights = self.bank.weigh(self.weights, self.evidence)

    def _remember_current(self) -> None:
        seen, usual = self.tracker.since.mean_current_a, self._usual_current_a
        if seen is not None:
            self._usual_current_a = seen if usual is None else 0.7 * usual + 0.3 * seen
