"""Drive a distance straight on or back."""

from __future__ import annotations

from executive.core.types import Outcome, Point, Reason
from executive.core.values import ANGLE, LENGTH, POINT
from executive.navigation import guidance
from executive.navigation.guidance import Belts
from executive.tree.nodes.base import In
from executive.tree.nodes.driving import DrivingLeaf


class DriveStraight(DrivingLeaf):
    """Drive `distance` along the body's x axis, backwards if negative, turning by `turn` on the way."""

    distance = In[float](LENGTH, "how far; negative is backwards")
    turn = In[float](ANGLE, "rotation superimposed, left positive", default=0.0)

    def belts(self) -> Outcome[Belts]:
        motion = self.services.classification.motion
        gauge = self.services.rig.rover.track_gauge_m
        distance, turn = self._undone * self.distance, self._undone * self.turn
        return Outcome(Reason.DONE, value=guidance.straight(motion, distance, turn, gauge))


class DriveBlind(DrivingLeaf):
    """Drive all the way to `target` in one go, on belt travel alone."""

    target = In[Point](POINT, "where to drive")

    def belts(self) -> Outcome[Belts]:
        motion = self.services.classification.motion
        pose, gauge = motion.pose(), self.services.rig.rover.track_gauge_m
        distance = guidance.distance_m(pose, self.target)
        error = guidance.heading_error_rad(pose, self.target)
        return Outcome(Reason.DONE, value=guidance.straight(motion, distance, error, gauge))
