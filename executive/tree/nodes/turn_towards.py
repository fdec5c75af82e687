"""Turn on the spot towards a point."""

from __future__ import annotations

import math
from typing import ClassVar

from executive.core import corridor
from executive.core.types import (
    Outcome,
    Point,
    PoseEstimate,
    Reason,
)
from executive.core.values import POINT
from executive.navigation import guidance
from executive.navigation.guidance import Belts
from executive.tree.nodes.base import In
from executive.tree.nodes.driving import DRIVING_OUTCOMES, DrivingLeaf

MOST_TURNS = 6  # in a row without coming nearer: soil that was learnt needs two or three
NEARER = 0.8  # of the least error so far counts as nearer
LEAST_ROOM_M = 0.01  # to the off-track margin; turns of less belt travel come to nothing
HERE_M = 0.05  # a rover that has come so far from where it began to turn turns anew


class TurnTowards(DrivingLeaf):
    """Turn on the spot to face `target`, as far as the motion model knows this soil.

    Near the off-track margin it turns in parts, each to be verified. Fails OFF_HEADING after six turns that
    came no nearer.
    """

    target = In[Point](POINT, "what to face")

    outcomes: ClassVar[tuple[Reason, ...]] = (*DRIVING_OUTCOMES, Reason.OFF_HEADING)

    _target: Point | None = None
    _began_at: Point | None = None
    _least_rad = math.inf
    _in_vain = 0

    def belts(self) -> Outcome[Belts]:
        motion = self.services.classification.motion
        pose = motion.pose()
        error = guidance.heading_error_rad(pose, self.target)
        if self._turned_in_vain(pose, abs(error)):
            detail = f"{MOST_TURNS} turns came no nearer than {math.degrees(self._least_rad):.1f} deg"
            self._target = None  # asked once more, perhaps after a remedy, it tries again
            outcome: Outcome[Belts] = Outcome(Reason.OFF_HEADING, detail)
            self.services.classification.on_failure(outcome)
            return outcome
        belts = guidance.turn(motion, error, self.services.rig.rover.track_gauge_m)
        if self.segment is not None:
            room_m = corridor.room_m(pose, self.segment, self.sigmas)
            if room_m < LEAST_ROOM_M:
                return Outcome(Reason.OFF_TRACK, f"{room_m * 1e3:.0f} mm to the margin, too near to turn")
            belts = guidance.within_room(belts, room_m)
        return Outcome(Reason.DONE, value=belts)

    def _turned_in_vain(self, pose: PoseEstimate, error_rad: float) -> bool:
        """Whether as many turns as are allowed have come no nearer to this target, here."""
        began = self._began_at
        moved = began is None or math.hypot(pose.x_m - began.x_m, pose.y_m - began.y_m) > HERE_M
        if moved or self.target != self._target:
            self._target, self._began_at = self.target, pose.point
            self._least_rad, self._in_vain = math.inf, 0
        if error_rad < NEARER * self._least_rad:
            self._least_rad, self._in_vain = error_rad, 0
        else:
            self._in_vain += 1
        return self._in_vain >= MOST_TURNS
