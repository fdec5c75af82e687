"""All that a choice may rest on."""

from __future__ import annotations

from dataclasses import dataclass, field

from executive.core.types import Outcome, PoseEstimate, Segment
from executive.isc import Assessment, Doubt, Readings


@dataclass(frozen=True)
class Situation:
    """What failed, what the classification makes of it, where the rover is, and what its devices read."""

    time_s: float
    failure: Outcome[object]
    assessment: Assessment
    pose: PoseEstimate
    segment: Segment | None
    readings: Readings = field(default_factory=Readings)
    doubt: Doubt | None = None
    """Where else the rover may be, and the way driven since the last fix that can be trusted."""

    @property
    def along_m(self) -> float | None:
        """The place along the segment; None where there is no segment."""
        track = self.pose.on(self.segment).track
        return track.along_m if track else None
