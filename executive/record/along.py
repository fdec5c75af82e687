"""How far along its route the rover is, from the events of the record."""

from __future__ import annotations

from executive.core.ordered_sum import ordered_sum
from executive.core.types import PoseEstimate, PoseSource, Segment
from executive.record.events import SegmentEvent, WaypointEvent


class AlongRoute:
    """Listens to the events of a run; what it says is by the last fix, not by what was predicted since."""

    def __init__(self, route: tuple[Segment, ...]) -> None:
        self._route = route
        self._segment: Segment | None = None
        self._pose: PoseEstimate | None = None
        self.reached = 0
        """How many way-points have been reached."""

    def hear(self, event: object, time_s: float) -> None:
        """Take an event into account."""
        if isinstance(event, SegmentEvent):
            self._segment = event.segment
        elif isinstance(event, PoseEstimate) and event.source != PoseSource.PREDICTION:
            self._pose = event
        elif isinstance(event, WaypointEvent):
            self.reached = max(self.reached, event.index + 1)

    @property
    def length_m(self) -> float:
        """Of the whole route [m]."""
        return ordered_sum(s.length_m for s in self._route)

    def behind_m(self) -> float:
        """How much of the route lies behind the rover [m]."""
        if self._segment is None or self._pose is None:
            return 0.0
        behind = ordered_sum(s.length_m for s in self._route[: self._segment.index])
        along = self._segment.offset(self._pose.x_m, self._pose.y_m).along_m
        return behind + min(max(along, 0.0), self._segment.length_m)

    def share(self) -> float:
        """The same as a share of the whole, 0 to 1."""
        return self.behind_m() / self.length_m
