"""The run's journal: what leaves and pool have to say, turned into events of the record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from executive.core.clock import Clock
from executive.core.ports import Devices
from executive.core.types import (
    Call,
    CameraView,
    Images,
    Outcome,
    PoseEstimate,
    Segment,
)
from executive.isc import Assessment, Sensed
from executive.pool import Attempt, Choice
from executive.record import events
from executive.record.pictures import annotated, picture
from executive.record.recorder import Recorder

CAMERAS = ("left", "right")
KEEP_EVERY = 5
VIEW_PX = 320


class RunJournal:
    """Writes to the recorder at mission time. The recorder may break the run; nothing else here may."""

    def __init__(self, recorder: Recorder, clock: Clock, route: tuple[Segment, ...]) -> None:
        self._recorder, self._clock, self._route = recorder, clock, route
        self._attempts: Counter[str] = Counter()
        self._looks = 0
        self._segment: Segment | None = None
        self._pose: PoseEstimate | None = None
        self.hear: Callable[[object], None] = lambda event: None
        self.called: Call | None = None
        self.reached = 0

    def write(self, event: object) -> None:
        """Write any event of the record at the present mission time."""
        self._recorder.write(event, self._clock.now_s)
        self.hear(event)

    def estimate(self, pose: PoseEstimate) -> None:
        self._pose = pose
        self.write(pose)

    def segment(self, segment: Segment | None) -> None:
        self._segment = segment
        self.write(events.SegmentEvent(segment))

    def waypoint(self, index: int, pose: PoseEstimate) -> None:
        target = self._route[0].start if index == 0 else self._route[index - 1].end
        self.reached = max(self.reached, index + 1)
        self.write(events.WaypointEvent(index, target, pose))

    def missed(self) -> str | None:
        """What a tree that succeeds has left out: way-points, if it reports any at all; None for nothing."""
        total = len(self._route) + 1
        return f"{self.reached} of {total} way-points were reached" if 0 < self.reached < total else None

    def call(self, call: Call) -> None:
        self.called = call
        self.write(call)

    def assessment(self, assessment: Assessment) -> None:
        self.write(events.HypothesesEvent(dict(assessment.weights), assessment.time_to_margin_s))

    def views(self, views: tuple[CameraView, ...], outcome: Outcome[object]) -> None:
        """Keep every fifth look, and each that failed."""
        self._looks += 1
        if outcome.ok and self._looks % KEEP_EVERY != 1:
            return
        caption = outcome.detail if not outcome.ok else ""
        for name, view in zip(CAMERAS, views, strict=False):
            image, marks = annotated(
                view.counts,
                view.window,
                name,
                {i: (float(u), float(v)) for i, (u, v) in enumerate(view.detected_px)},
                {i: (float(u), float(v)) for i, (u, v) in enumerate(view.reprojected_px)},
                caption=caption,
                longest_px=VIEW_PX,
            )
            self.write(image)
            self.write(marks)

    def picture(self, images: Images) -> None:
        for name, counts in zip(CAMERAS, images.counts, strict=True):
            event, _ = picture(counts[-1], name)
            self.write(event)

    def strategy(self, note: Choice | Attempt) -> None:
        """The pool's choices and their effects."""
        if isinstance(note, Choice):
            self._chosen(note)
            return
        verdict = events.Verdict.HELPED if note.helped else events.Verdict.FAILED
        self.write(self._strategy_event(note.strategy, note.hypothesis, note.weight, verdict, ""))

    def telemetry(self, now: Sensed, devices: Devices, predicted: PoseEstimate) -> None:
        """One sample of all that is read continuously, and of where the rover should be by it."""
        if now.tracks.moving:
            self.write(predicted.on(self._segment))
        cabin, head = devices.cabin.read(), devices.head.read()
        self.write(
            events.Telemetry(
                left_m=now.tracks.left_m,
                right_m=now.tracks.right_m,
                left_current_a=now.tracks.left_current_a,
                right_current_a=now.tracks.right_current_a,
                roll_rad=now.tilt.roll_rad,
                pitch_rad=now.tilt.pitch_rad,
                arm_rad=cabin.arm_rad,
                cabin_rad=cabin.cabin_rad,
                pan_rad=head.pan_rad,
                tilt_rad=head.tilt_rad,
                tether_m=now.tether.length_m,
                tether_n=now.tether.tension_n,
                moving=now.tracks.moving,
            )
        )

    def along_route_m(self) -> float:
        """How much of the route lies behind the rover, by the last fix [m]."""
        if self._segment is None or self._pose is None:
            return 0.0
        behind = sum(s.length_m for s in self._route[: self._segment.index])
        along = self._segment.offset(self._pose.x_m, self._pose.y_m).along_m
        return behind + min(max(along, 0.0), self._segment.length_m)

    def progress(self) -> float:
        """The share of the route that lies behind the rover, 0 to 1."""
        return self.along_route_m() / sum(s.length_m for s in self._route)

    def to_go_text(self) -> str:
        """What remains, for people."""
        remaining = sum(s.length_m for s in self._route) - self.along_route_m()
        return f"{remaining:.2f} m to go"

    def _chosen(self, choice: Choice) -> None:
        if choice.strategy is None:
            refusals = "; ".join(f"{c.name}: {c.refused}" for c in choice.candidates if c.refused)
            message = f"no strategy for {choice.hypothesis} at {choice.weight:.2f}: {choice.why} ({refusals})"
            self.write(events.LogEvent(events.Level.WARNING, "pool", message))
            return
        self._attempts[choice.strategy] += 1
        self.write(
            self._strategy_event(
                choice.strategy, choice.hypothesis, choice.weight, events.Verdict.CHOSEN, choice.why
            )
        )

    def _strategy_event(
        self, name: str, hypothesis: str, weight: float, verdict: events.Verdict, why: str
    ) -> events.StrategyEvent:
        return events.StrategyEvent(name, hypothesis, weight, self._attempts[name], verdict, why)
