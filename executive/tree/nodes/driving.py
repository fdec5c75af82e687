"""What every driving leaf shares: a drive of the belts under supervision, its pose predicted on."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from executive.core import corridor
from executive.core.devices import DRIVE
from executive.core.ports import Action
from executive.core.types import (
    Outcome,
    PoseEstimate,
    Reason,
    Segment,
    TrackReading,
)
from executive.core.values import (
    ANGLE,
    DURATION,
    FORCE,
    NUMBER,
    POSE,
    SEGMENT,
)
from executive.isc import Sensed
from executive.navigation.belt_watch import BeltWatch
from executive.navigation.guidance import Belts
from executive.tree.nodes.action import ActionLeaf
from executive.tree.nodes.base import FromTree, In, Out

DRIVING_OUTCOMES: tuple[Reason, ...] = (
    Reason.DONE,
    Reason.BLOCKED,
    Reason.TILT,
    Reason.TETHER,
    Reason.OFF_TRACK,
    Reason.DEVICE,
)


class DrivingLeaf(ActionLeaf):
    """Drives the belts; stops on tilt, pull of the tether, a belt that does not count, before the margin.

    Leaves the predicted pose behind.
    """

    needs = ("drive",)

    pose = Out[PoseEstimate](POSE, "the pose, predicted on while driving")
    segment = In[Segment | None](SEGMENT, "the segment under way", default=FromTree("segment"))
    tilt_limit = In[float](ANGLE, "stop at this tilt", default=math.radians(25.0))
    tension_limit = In[float](FORCE, "stop at this pull; half of one at a snag may not be felt", default=4.0)
    sigmas = In[float](NUMBER, "standard deviations to keep from the off-track margin", default=2.0)
    patience = In[float](DURATION, "how late the belts' own word may be that they are there", default=10.0)

    outcomes: ClassVar[tuple[Reason, ...]] = DRIVING_OUTCOMES

    _undone = 1.0
    """Share of the drive that is left to do, where it goes on after it was cut off."""

    def begin(self) -> None:
        self._undone = 1.0
        super().begin()

    def resume(self) -> None:
        """Plan anew from where the rover was found."""
        self._undone *= self._belts.undone(self.services.devices[DRIVE].read())
        super().begin()

    def belts(self) -> Outcome[Belts]:
        """The belt travels to drive, or why not."""
        raise TypeError(f"{type(self).__name__} has no belts")

    def request(self) -> Action[TrackReading] | Outcome[Any]:
        planned = self.belts()
        if not planned.ok or planned.value is None:
            return planned
        speed, tracks = self.services.rig.rover.speed_m_s, self.services.devices[DRIVE]
        self._belts = BeltWatch(planned.value, speed, tracks.read())
        return tracks.drive(planned.value.left_m, planned.value.right_m, speed)

    def due_s(self) -> float:
        """By the mission's clock what the belts' watch asks of their own: a reading that is old ages not."""
        return self._belts.longest_s

    def watch(self) -> Outcome[object] | None:
        problem = self._problem(self._carry_on())
        if problem is not None:
            self.services.classification.on_failure(problem)
        return problem

    def _problem(self, pose: PoseEstimate) -> Outcome[object] | None:
        """Why this drive must not go on, None if it may."""
        sensed = self.services.classification.tracker.sensed
        if sensed is not None and (problem := self._read_problem(sensed)):
            return problem
        return None if self.segment is None else self._margin_problem(pose, self.segment)

    def _margin_problem(self, pose: PoseEstimate, segment: Segment) -> Outcome[object] | None:
        """Why this drive may leave the corridor: by the pose, or by the belts where the pose is in doubt."""
        room_m = corridor.room_m(pose, segment, self.sigmas)
        if room_m <= 0.0:
            return Outcome(Reason.OFF_TRACK, f"may be {-room_m * 1e3:.0f} mm beyond the margin")
        doubt = self.services.classification.tracker.doubt
        if (room_m := doubt.room_m(segment, self.sigmas)) <= 0.0:
            message = f"may be {-room_m * 1e3:.0f} mm beyond the margin if the last fixes are false"
            return Outcome(Reason.OFF_TRACK, message)
        exceeded = doubt.exceeded(segment)
        return None if exceeded is None else Outcome(Reason.OFF_TRACK, exceeded)

    def _read_problem(self, sensed: Sensed) -> Outcome[object] | None:
        """What the readings say against going on, of the devices that this robot has."""
        if miscount := self._belts.problem(sensed.tracks):
            return Outcome(Reason.DEVICE, miscount)
        if (tilt := sensed.tilt) is not None:
            tilt_rad = math.hypot(tilt.roll_rad, tilt.pitch_rad)
            if tilt_rad > self.tilt_limit:
                return Outcome(Reason.TILT, f"{math.degrees(tilt_rad):.1f} deg")
        if sensed.tether is not None and sensed.tether.tension_n > self.tension_limit:
            return Outcome(Reason.TETHER, f"pulls with {sensed.tether.tension_n:.1f} N")
        return None

    def finish(self, outcome: Outcome[TrackReading]) -> Outcome[Any]:
        self._carry_on()
        if not outcome.ok:
            self.services.classification.on_failure(outcome)
        return outcome

    def halt(self) -> None:
        super().halt()
        self.services.devices[DRIVE].stop()

    def _carry_on(self) -> PoseEstimate:
        self.pose = self.services.classification.predicted().on(self.segment)
        return self.pose
