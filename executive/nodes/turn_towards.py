"""Turn on the spot towards a point."""

from __future__ import annotations

from executive import guidance
from executive.guidance import Belts
from executive.nodes.base import In
from executive.nodes.driving import DrivingLeaf
from executive.types import Outcome, Point, Reason
from executive.values import POINT


class TurnTowards(DrivingLeaf):
    """Turn on the spot to face `target`, as far as the motion model knows this soil."""

    target = In[Point](POINT, "what to face")

    def belts(self) -> Outcome[Belts]:
        motion = self.services.classification.motion
        error = guidance.heading_error_rad(motion.pose(), self.target)
        return Outcome(Reason.DONE, value=guidance.turn(motion, error, self.services.rig.rover.track_gauge_m))
