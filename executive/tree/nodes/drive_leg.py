"""Drive the next leg of a trek."""

from __future__ import annotations

from executive.core.types import Outcome, Point, Reason
from executive.core.values import LENGTH, POINT
from executive.navigation import guidance
from executive.navigation.guidance import Belts, GuidanceLimits
from executive.tree.nodes.base import In
from executive.tree.nodes.driving import DRIVING_OUTCOMES, DrivingLeaf


class DriveLeg(DrivingLeaf):
    """Drive one leg towards `target`, the correction superimposed; never towards the off-track margin."""

    target = In[Point](POINT, "where the trek goes")
    longest = In[float](LENGTH, "length of a leg", default=0.10)

    outcomes = (*DRIVING_OUTCOMES, Reason.OFF_HEADING, Reason.OVERSHOOT)

    def belts(self) -> Outcome[Belts]:
        motion = self.services.classification.motion
        segment = self.segment
        if segment is None:
            return Outcome(Reason.OFF_TRACK, "no segment to drive on")
        return guidance.plan_leg(
            motion,
            motion.pose(),
            self.target,
            segment,
            self.longest,
            self.services.rig.rover.track_gauge_m,
            GuidanceLimits(),
        )
