"""Leaves about the plan: a way-point reached, the length of legs, what to make of the soil."""

from __future__ import annotations

import math

from executive.core import corridor
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
    POINT,
    POSE,
    ROUTE,
    SEGMENT,
    TEXT,
)
from executive.isc.motion import ADVANCE, YAW_EFFICIENCY
from executive.tree.nodes.base import (
    FromTree,
    In,
    InOut,
    Leaf,
    Out,
)


class BeginSegment(Leaf):
    """Make `segment` the one under way: margins and cross-track errors are of it from now on."""

    segment = In[Segment](SEGMENT, "the segment that begins")
    pose = InOut[PoseEstimate](POSE, "the pose, its offset now from this segment")

    def step(self) -> Outcome[object]:
        self.services.journal.segment(self.segment)
        self.pose = self.pose.on(self.segment)
        return Outcome(Reason.DONE)


class StartHere(Leaf):
    """Report the first way-point as reached, if the rover stands in its tolerance zone by two sigma."""

    route = In[tuple[Segment, ...]](ROUTE, "the route")
    pose = In[PoseEstimate](POSE, "the pose")

    outcomes = (Reason.DONE, Reason.OFF_TRACK, Reason.ARRIVAL_UNCERTAIN)

    def step(self) -> Outcome[object]:
        judged = self.services.journal.waypoint(0, self.pose)
        return Outcome(Reason.OFF_TRACK, judged.detail) if judged.reason is Reason.UNEXPECTED else judged


class WaypointReached(Leaf):
    """Report the end of `segment` as reached, if the rover stands in its tolerance zone by two sigma."""

    segment = In[Segment](SEGMENT, "the segment that ends here")
    pose = In[PoseEstimate](POSE, "the pose")

    outcomes = (Reason.DONE, Reason.UNEXPECTED, Reason.ARRIVAL_UNCERTAIN)

    def step(self) -> Outcome[object]:
        return self.services.journal.waypoint(self.segment.index + 1, self.pose)


class SetLeg(Leaf):
    """Set the length of the legs of a trek."""

    leg = Out[float](LENGTH, "the length written")
    to = In[float](LENGTH, "its new value")

    def step(self) -> Outcome[object]:
        self.leg = self.to
        return Outcome(Reason.DONE, f"{self.to * 1e3:.0f} mm")


class Compensate(Leaf):
    """Adopt the turning or advance ratio last seen as this soil's own, with fresh uncertainty."""

    of = In[str](TEXT, "the ratio to adopt", choices=("turning", "advance"))

    outcomes = (Reason.DONE, Reason.GUARD)

    def step(self) -> Outcome[object]:
        classification = self.services.classification
        turning = self.of == "turning"
        ratio = classification.observed_turn_ratio if turning else classification.observed_advance_ratio
        if ratio is None:
            return Outcome(Reason.GUARD, f"no {self.of} was observed since the last fix")
        ratio = max(ratio, 0.2)
        parameter = YAW_EFFICIENCY if turning else ADVANCE
        classification.tracker.reset_parameter(parameter, ratio, sigma=0.3)
        classification.settle()
        return Outcome(Reason.DONE, f"{self.of} ratio {ratio:.2f} adopted")


class InflatePrediction(Leaf):
    """Inflate the covariance of the prediction, so that the next fix may lie elsewhere."""

    former_names = ("doubt_prediction",)

    position = In[float](LENGTH, "standard deviation added to the place", default=0.15)
    heading = In[float](ANGLE, "standard deviation added to the heading", default=math.radians(20.0))

    def step(self) -> Outcome[object]:
        self.services.classification.tracker.inflate(self.position, self.position, self.heading)
        return Outcome(Reason.DONE)


class DeadReckon(Leaf):
    """Take the predicted pose for the pose."""

    pose = Out[PoseEstimate](POSE, "the pose, as predicted from the belts alone")
    segment = In[Segment | None](SEGMENT, "the segment under way", default=FromTree("segment"))

    def step(self) -> Outcome[object]:
        self.pose = self.services.classification.predicted().on(self.segment)
        return Outcome(Reason.DONE)


class ChooseSide(Leaf):
    """Choose a point ahead and aside, on the side where the off-track margin leaves more room.

    Ahead ends with the segment: nothing is looked for beyond.
    """

    pose = In[PoseEstimate](POSE, "the pose")
    segment = In[Segment](SEGMENT, "the segment under way")
    beside = In[float](LENGTH, "how far to the side of the present place")
    ahead = In[float](LENGTH, "how far ahead along the segment")
    point = Out[Point](POINT, "the point chosen")

    outcomes = (Reason.DONE, Reason.OFF_TRACK)

    def step(self) -> Outcome[object]:
        segment = self.segment
        offset = segment.offset(self.pose.x_m, self.pose.y_m)
        side = -1.0 if offset.cross_m > 0 else 1.0
        cross = offset.cross_m + side * self.beside
        along = min(offset.along_m + self.ahead, max(segment.length_m, offset.along_m))
        c, s = math.cos(segment.bearing_rad), math.sin(segment.bearing_rad)
        point = Point(segment.start.x_m + c * along - s * cross, segment.start.y_m + s * along + c * cross)
        away_m = corridor.distance_m(segment, point.x_m, point.y_m)
        if away_m + 2 * self.pose.sigma_position_m >= segment.off_track_m:
            return Outcome(Reason.OFF_TRACK, "no room beside")
        self.point = point
        return Outcome(Reason.DONE, "to the left" if side > 0 else "to the right")
