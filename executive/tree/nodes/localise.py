"""Measure where the rover is."""

from __future__ import annotations

from typing import ClassVar

from executive.core.devices import DRIVE
from executive.core.ports import Action, LocaliseRequest
from executive.core.types import (
    Localisation,
    Outcome,
    PoseEstimate,
    Quality,
    Reason,
    Segment,
)
from executive.core.values import (
    ANGLE,
    DURATION,
    LENGTH,
    POSE,
    QUALITY,
    SEGMENT,
)
from executive.tree.nodes.action import ActionLeaf
from executive.tree.nodes.base import FromTree, In, Out


class Localise(ActionLeaf):
    """Measure the rover's pose by vision, at rest, and hold it against the prediction."""

    quality = In[Quality](QUALITY, "trend, precise or far", default=Quality.PRECISE)
    pose = Out[PoseEstimate](POSE, "the pose, as measured and predicted")
    segment = In[Segment | None](SEGMENT, "the segment under way", default=FromTree("segment"))
    budget = In[float](DURATION, "mission time it may take", default=900.0)
    position = In[float](LENGTH, "standard deviation wanted; 0: that of the quality", default=0.0)
    yaw = In[float](ANGLE, "standard deviation wanted; 0: that of the quality", default=0.0)
    settle = In[float](DURATION, "time at rest before the first exposure", default=5.0)
    patience = In[float](DURATION, "how long after its budget it may end", default=300.0)

    needs = ("drive",)
    outcomes: ClassVar[tuple[Reason, ...]] = (
        Reason.DONE,
        Reason.NOT_SEEN,
        Reason.POOR_VIEW,
        Reason.UNSTABLE_IMAGES,
        Reason.IMPLAUSIBLE,
        Reason.MISALIGNED,
        Reason.OUT_OF_REACH,
        Reason.TIMEOUT,
        Reason.DEVICE,
    )

    late = Reason.TIMEOUT

    def begin(self) -> None:
        self._action, self._settled = None, None
        self.services.devices[DRIVE].stop()
        clock = self.services.clock
        self._start_tick = clock.ticks + clock.ticks_for(self.settle)

    def step(self) -> Outcome[object] | None:
        if self.services.clock.ticks < self._start_tick:
            return None
        if self._action is None:
            self._start_s = self.services.clock.now_s
            self.start()
        return super().step()

    def request(self) -> Action[Localisation]:
        predicted = self.services.classification.predicted()
        request = LocaliseRequest(self.quality, predicted, self.budget, self.segment, self.position, self.yaw)
        return self.services.localizer.locate(request)

    def due_s(self) -> float:
        return self.budget

    def finish(self, outcome: Outcome[Localisation]) -> Outcome[PoseEstimate]:
        seen = outcome.value or Localisation(None)
        self.services.journal.views(seen.views, outcome)
        return self._weighed(self.gate_fix(Outcome(outcome.reason, outcome.detail, seen.pose)))

    def _weighed(self, outcome: Outcome[PoseEstimate]) -> Outcome[PoseEstimate]:
        """Tell the classification, the record and the tree."""
        classification = self.services.classification
        if not outcome.ok or outcome.value is None:
            classification.on_failure(outcome)
            return outcome
        fix = outcome.value.on(self.segment)
        classification.on_fix(fix)
        self.services.journal.estimate(fix)
        self.pose = classification.fuse(fix).on(self.segment)
        return Outcome(Reason.DONE, "; ".join(filter(None, (_summary(fix), outcome.detail))), fix)

    def gate_fix(self, outcome: Outcome[PoseEstimate]) -> Outcome[PoseEstimate]:
        """The outcome; IMPLAUSIBLE in place of a pose that is no number, old, or out of the belts' reach."""
        if not outcome.ok or outcome.value is None:
            return outcome
        why = self.services.classification.tracker.gate_fix(outcome.value, self._start_s)
        return Outcome(Reason.IMPLAUSIBLE, why) if why else outcome


def _summary(fix: PoseEstimate) -> str:
    rests_on = f"{fix.markers} markers" if fix.markers else fix.source
    return f"{rests_on}, sigma {fix.sigma_position_m * 1e3:.1f} mm"
