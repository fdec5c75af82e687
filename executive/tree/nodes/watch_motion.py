"""Look on while the rover drives."""

from __future__ import annotations

import math

import numpy as np

from executive.core.ports import Action, LocaliseRequest
from executive.core.types import (
    Localisation,
    Outcome,
    PoseEstimate,
    Quality,
    Reason,
)
from executive.core.values import LENGTH, NUMBER
from executive.isc.evidence_check import unusable
from executive.tree.nodes.base import In, Leaf

MOST_ASTRAY = 2  # tendencies in a row
BUDGET_S = 120.0  # of one look
PATIENCE_S = 60.0  # beyond it: a look that does not end is given up, and the next one begun


class WatchMotion(Leaf):
    """Supervise a drive by motion fragments: follow with the head, fail when the tendency is wrong.

    Never succeeds by itself: run it in a parallel beside the drive. A frame pair that shows nothing is
    no evidence, and one that shows the rover elsewhere may show something else that moves: two in a row
    must say so. The precise check after the drive decides.
    """

    gate = In[float](NUMBER, "standard deviations that the tendency may be off", default=4.0)
    allowance = In[float](
        LENGTH, "what a tendency may be off by besides its covariance: other things move too", default=0.25
    )

    outcomes = (Reason.UNEXPECTED,)
    _action: Action[Localisation] | None = None

    def begin(self) -> None:
        self._predictions: dict[float, PoseEstimate] = {}
        self._astray = 0

    def step(self) -> Outcome[object] | None:
        clock, predicted = self.services.clock, self.services.classification.predicted()
        self._predictions[predicted.time_s] = predicted
        if self._action is None:
            request = LocaliseRequest(Quality.TREND, predicted, budget_s=BUDGET_S)
            self._action, self._asked_s = self.services.localizer.locate(request), predicted.time_s
            self._until_ticks = clock.ticks + clock.ticks_for(BUDGET_S + PATIENCE_S)
            return None
        outcome = self._action.poll()
        if outcome is None:
            if clock.ticks >= self._until_ticks:
                self.halt()
            return None
        self._action = None
        seen = outcome.value.pose if outcome.ok and outcome.value is not None else None
        return None if seen is None or unusable(seen, self._asked_s) else self._judge(seen)

    def halt(self) -> None:
        if self._action is not None:
            self._action.cancel()
            self._action = None

    def _predicted_at(self, time_s: float) -> PoseEstimate:
        """The prediction nearest to the time of the frames, which lie some way back."""
        return self._predictions[min(self._predictions, key=lambda known: abs(known - time_s))]

    def _judge(self, seen: PoseEstimate) -> Outcome[object] | None:
        predicted = self._predicted_at(seen.time_s)
        off = np.array([seen.x_m - predicted.x_m, seen.y_m - predicted.y_m])
        beyond = max(0.0, 1.0 - self.allowance / max(float(np.hypot(*off)), 1e-9)) * off
        spread = seen.covariance[:2, :2] + predicted.covariance[:2, :2]
        distance = math.sqrt(float(beyond @ np.linalg.solve(spread, beyond)))
        self._astray = 0 if distance <= self.gate else self._astray + 1
        if not self._astray:
            self.services.journal.estimate(seen)
        if self._astray < MOST_ASTRAY:
            return None
        return Outcome(Reason.UNEXPECTED, f"seen {np.hypot(*off) * 1e3:.0f} mm from the prediction")
