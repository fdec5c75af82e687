"""Questions about the pose: each succeeds or fails at once, with its reason."""

from __future__ import annotations

import math

from executive.core import corridor
from executive.core.arrival import radius_m
from executive.core.types import (
    Outcome,
    Point,
    PoseEstimate,
    Reason,
    Segment,
)
from executive.core.values import (
    ANGLE,
    LENGTH,
    NUMBER,
    POINT,
    POSE,
    SEGMENT,
)
from executive.isc.bank import NOMINAL
from executive.navigation import guidance
from executive.tree.nodes.base import In, Leaf


class Facing(Leaf):
    """Does the rover face `target`? Also yes if going on as it faces misses it by less than `slack`."""

    condition = True

    target = In[Point](POINT, "what to face")
    pose = In[PoseEstimate](POSE, "the pose")
    tolerance = In[float](ANGLE, "heading error allowed", default=math.radians(0.5))
    slack = In[float](LENGTH, "miss distance allowed", default=0.0)

    outcomes = (Reason.DONE, Reason.OFF_HEADING)

    def step(self) -> Outcome[object]:
        error = guidance.heading_error_rad(self.pose, self.target)
        miss = abs(guidance.distance_m(self.pose, self.target) * math.sin(error))
        ahead = abs(error) < math.pi / 2
        ok = abs(error) <= self.tolerance or (ahead and miss <= self.slack)
        return Outcome(Reason.DONE if ok else Reason.OFF_HEADING, f"{math.degrees(error):+.2f} deg")


class Arrived(Leaf):
    """Is the rover within the tolerance zone of `target`, its uncertainty allowed for?"""

    condition = True

    target = In[Point](POINT, "the centre of the zone")
    pose = In[PoseEstimate](POSE, "the pose")
    within = In[float](LENGTH, "radius of the zone")
    share = In[float](NUMBER, "share of the radius to aim for", default=0.6)

    outcomes = (Reason.DONE, Reason.GUARD)

    def step(self) -> Outcome[object]:
        remaining = guidance.distance_m(self.pose, self.target)
        radius = min(self.share * self.within, radius_m(self.pose, self.within))
        reason = Reason.DONE if remaining <= radius else Reason.GUARD
        return Outcome(reason, f"{remaining * 1e3:.0f} mm to go")


class NotOvershot(Leaf):
    """Is `target` still ahead? Fails when it lies behind, near, and outside its tolerance zone."""

    condition = True

    target = In[Point](POINT, "where the trek goes")
    pose = In[PoseEstimate](POSE, "the pose")
    within = In[float](LENGTH, "radius of the tolerance zone")
    near = In[float](LENGTH, "how far behind still counts as overshot", default=0.3)

    outcomes = (Reason.DONE, Reason.OVERSHOOT)

    def step(self) -> Outcome[object]:
        remaining = guidance.distance_m(self.pose, self.target)
        behind = abs(guidance.heading_error_rad(self.pose, self.target)) > math.radians(100.0)
        if behind and remaining <= self.near:
            outcome: Outcome[object] = Outcome(Reason.OVERSHOOT, f"by {remaining * 1e3:.0f} mm")
            self.services.classification.on_failure(outcome)
            return outcome
        return Outcome(Reason.DONE)


class InsideMargin(Leaf):
    """Is the rover in the segment's corridor, which ends past its ends, its uncertainty allowed for?"""

    condition = True

    pose = In[PoseEstimate](POSE, "the pose")
    segment = In[Segment](SEGMENT, "the segment under way")
    sigmas = In[float](NUMBER, "standard deviations to allow for", default=2.0)

    outcomes = (Reason.DONE, Reason.OFF_TRACK)

    def step(self) -> Outcome[object]:
        away_m = corridor.distance_m(self.segment, self.pose.x_m, self.pose.y_m)
        inside = corridor.room_m(self.pose, self.segment, self.sigmas) > 0.0
        reason = Reason.DONE if inside else Reason.OFF_TRACK
        return Outcome(reason, f"{away_m * 1e3:.0f} mm off the segment")


class AsPredicted(Leaf):
    """Did the rover move as the motion model says? Fails when another explanation is likelier.

    A marker lost or a poor view is none: the fix was had, and its covariance says how good it is.
    """

    condition = True

    below = In[float](NUMBER, "weight an anomaly may have", default=0.6)

    outcomes = (Reason.DONE, Reason.UNEXPECTED)

    def step(self) -> Outcome[object]:
        classification = self.services.classification
        assessment = classification.assess()
        anomaly, weight = assessment.anomaly
        moved_otherwise = not classification.bank.moves_as_predicted(anomaly)
        if anomaly == assessment.likeliest and moved_otherwise and weight >= self.below:
            return Outcome(Reason.UNEXPECTED, f"{anomaly} at {weight:.2f}")
        nominal = assessment.weights[NOMINAL]
        return Outcome(Reason.DONE, f"nominal at {nominal:.2f}")
