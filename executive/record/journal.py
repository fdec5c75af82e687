"""The run's journal: what leaves and pool have to say, turned into events of the record."""

from __future__ import annotations

from collections import Counter

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
from executive.record.bus import EventBus
from executive.record.pictures import annotated, picture
from executive.record.telemetry import samples

CAMERAS = ("left", "right")
KEEP_EVERY = 5
VIEW_PX = 320


class RunJournal:
    """Publishes what it is told as events, on the bus that the recorder listens to."""

    def __init__(self, bus: EventBus, route: tuple[Segment, ...]) -> None:
        self._bus, self._route = bus, route
        self._attempts: Counter[str] = Counter()
        self._looks = 0
        self._segment: Segment | None = None
        self.called: Call | None = None
        self.reached = 0

    def write(self, event: object) -> None:
        """Write any event of the record at the present mission time."""
        self._bus.publish(event)

    def estimate(self, pose: PoseEstimate) -> None:
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
        for event in samples(now, devices):
            self.write(event)

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
