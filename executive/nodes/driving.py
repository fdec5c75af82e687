"""What every driving leaf shares: a drive of the belts under supervision, its pose predicted on."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from executive.guidance import Belts
from executive.nodes.action import ActionLeaf
from executive.nodes.base import FromTree, In, InOut
from executive.nodes.belt_watch import BeltWatch
from executive.ports import Action
from executive.types import Outcome, PoseEstimate, Reason, Segment, TrackReading
from executive.values import ANGLE, NUMBER, POSE, SEGMENT

DRIVING_OUTCOMES: tuple[Reason, ...] = (
    Reason.DONE,
    Reason.BLOCKED,
    Reason.TILT,
    Reason.OFF_TRACK,
    Reason.DEVICE,
)


class DrivingLeaf(ActionLeaf):
    """Drives the belts; stops on tilt, before the off-track margin, and when a belt does not count.

    Leaves the predicted pose behind.
    """

    pose = InOut[PoseEstimate](POSE, "the pose, predicted on while driving")
    segment = In[Segment | None](SEGMENT, "the segment under way", default=FromTree("segment"))  # type: ignore[arg-type]  # unset where a tree has none
    tilt_limit = In[float](ANGLE, "stop at this tilt", default=math.radians(25.0))
    sigmas = In[float](NUMBER, "standard deviations to keep from the off-track margin", default=2.0)

    outcomes: ClassVar[tuple[Reason, ...]] = DRIVING_OUTCOMES

    def belts(self) -> Outcome[Belts]:
        """The belt travels to drive, or why not."""
        raise TypeError(f"{type(self).__name__} has no belts")

    def request(self) -> Action[TrackReading] | Outcome[Any]:
        planned = self.belts()
        if not planned.ok or planned.value is None:
            return planned
        speed, tracks = self.services.rig.rover.speed_m_s, self.services.devices.tracks
        self._belts = BeltWatch(planned.value, speed, tracks.read())
        return tracks.drive(planned.value.left_m, planned.value.right_m, speed)

    def watch(self) -> Outcome[object] | None:
        pose = self._carry_on()
        telemetry = self.services.classification.telemetry
        if telemetry is not None and (problem := self._belts.problem(telemetry.tracks)):
            outcome: Outcome[object] = Outcome(Reason.DEVICE, problem)
            self.services.journal.assessment(self.services.classification.failed(outcome))
            return outcome
        tilt = telemetry.tilt if telemetry else None
        if tilt is not None and math.hypot(tilt.roll_rad, tilt.pitch_rad) > self.tilt_limit:
            return Outcome(Reason.TILT, f"{math.degrees(math.hypot(tilt.roll_rad, tilt.pitch_rad)):.1f} deg")
        if pose.track is not None and self.segment is not None:
            worst = abs(pose.track.cross_m) + self.sigmas * pose.sigma_across_m(self.segment)
            if worst >= self.segment.off_track_m:
                return Outcome(Reason.OFF_TRACK, f"cross-track error may be {worst * 1e3:.0f} mm")
        return None

    def finish(self, outcome: Outcome[TrackReading]) -> Outcome[Any]:
        self._carry_on()
        if not outcome.ok:
            self.services.journal.assessment(self.services.classification.failed(outcome))
        return outcome

    def halt(self) -> None:
        super().halt()
        self.services.devices.tracks.stop()

    def _carry_on(self) -> PoseEstimate:
        self.pose = self.services.classification.predicted().on(self.segment)
        return self.pose
