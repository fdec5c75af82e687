"""Measure as finely as a tolerance asks, where the pose does not say whether a way-point was reached."""

from __future__ import annotations

from executive.core.arrival import radius_m
from executive.core.ports import Action, LocaliseRequest
from executive.core.types import Localisation, Outcome, Point, PoseEstimate, Quality, Reason
from executive.core.values import LENGTH, NUMBER, POINT, POSE, QUALITY
from executive.navigation import guidance
from executive.tree.nodes.base import In, InOut
from executive.tree.nodes.localise import Localise

ENOUGH = 0.35
"""Standard deviation over radius at which a rover can still be led into the zone: 0.3 of it is left."""
WANTED = 0.30  # of the radius, asked of the localizer: its answer scatters
MOST_LOOKS = 3  # what does not average out by then does not average out


class MeasureArrival(Localise):
    """Near `target` and not sure to within its zone: measure longer. Elsewhere it is done at once.

    Fails ARRIVAL_UNCERTAIN where three such looks leave it open whether the rover stands in the zone.
    """

    quality = In[Quality](QUALITY, "trend, precise or far", default=Quality.FAR)
    pose = InOut[PoseEstimate](POSE, "the pose, as measured and predicted")
    target = In[Point](POINT, "the centre of the zone")
    within = In[float](LENGTH, "radius of the zone")
    share = In[float](NUMBER, "share of the radius within which it is asked", default=0.6)

    outcomes = (*Localise.outcomes, Reason.ARRIVAL_UNCERTAIN)

    _asked = True

    def begin(self) -> None:
        self._looks, self._asked = 0, self._open(self.pose)
        if self._asked:
            super().begin()

    def step(self) -> Outcome[object] | None:
        if not self._asked:
            return Outcome(Reason.DONE)
        measured = super().step()
        return self._judged(measured) if measured is not None and measured.ok else measured

    def request(self) -> Action[Localisation]:
        self._looks += 1
        predicted = self.services.classification.predicted()
        sigma_m = self.position or WANTED * self.within
        return self.services.localizer.locate(
            LocaliseRequest(self.quality, predicted, self.budget, self.segment, sigma_m, self.yaw)
        )

    def _judged(self, measured: Outcome[object]) -> Outcome[object] | None:
        """What a look that came off says of the arrival; None where another one may tell."""
        if not self._open(self.pose):
            return measured
        if self._looks < MOST_LOOKS:
            return None
        if self._away_m(self.pose) <= radius_m(self.pose, self.within):
            return measured
        message = f"two sigma {2e3 * self.pose.sigma_position_m:.0f} mm after {self._looks} looks"
        return Outcome(Reason.ARRIVAL_UNCERTAIN, f"{message}, tolerance {self.within * 1e3:.0f} mm")

    def _away_m(self, pose: PoseEstimate) -> float:
        return guidance.distance_m(pose, self.target)

    def _open(self, pose: PoseEstimate) -> bool:
        """Whether it is near, and the estimate too coarse to lead it into the zone or to say that it is."""
        near = self._away_m(pose) <= self.share * self.within
        return near and pose.sigma_position_m > ENOUGH * self.within
