"""The run's journal: what leaves and pool have to say, turned into events of the record."""

from __future__ import annotations

from collections import Counter

from executive.core.arrival import arrival
from executive.core.ports import Devices
from executive.core.types import (
    Call,
    CameraView,
    Images,
    Outcome,
    Point,
    PoseEstimate,
    Reason,
    Segment,
)
from executive.isc import Assessment, Sensed
from executive.isc.evidence_check import unfit
from executive.pool import Attempt, Choice
from executive.record import events
from executive.record.bus import EventBus
from executive.record.pictures import annotated, picture
from executive.record.telemetry import samples

CAMERAS = ("left", "right")
KEEP_EVERY = 5
VIEW_PX = 320


def waypoint_of(route: tuple[Segment, ...], index: int) -> tuple[Point, float]:
    """Where a way-point of a route lies, counted from 0, and the tolerance of it [m]."""
    if index > 0:
        return route[index - 1].end, route[index - 1].tolerance_m
    first = route[0]
    return first.start, first.tolerance_m if first.start_tolerance_m is None else first.start_tolerance_m


class RunJournal:
    """Publishes what it is told as events, on the bus that the recorder listens to."""

    def __init__(self, bus: EventBus, route: tuple[Segment, ...]) -> None:
        self._bus, self._route = bus, route
        self._attempts: Counter[str] = Counter()
        self._looks = 0
        self._segment: Segment | None = None
        self.called: Call | None = None
        self.reached: set[int] = set()

    def write(self, event: object) -> None:
        """Write any event of the record at the present mission time."""
        self._bus.publish(event)

    def estimate(self, pose: PoseEstimate) -> None:
        self.write(pose)

    def segment(self, segment: Segment | None) -> None:
        self._segment = segment
        self.write(events.SegmentEvent(segment))

    @property
    def under_way(self) -> Segment | None:
        """The segment under way."""
        return self._segment

    def waypoint(self, index: int, pose: PoseEstimate) -> Outcome[object]:
        """Judge a way-point that a leaf reports: reached only where this pose carries it, else why not."""
        target, within_m = waypoint_of(self._route, index)
        spoilt = unfit(pose.covariance)
        judged = arrival(pose, target, within_m)
        if judged.ok and spoilt is not None:
            judged = Outcome(Reason.ARRIVAL_UNCERTAIN, spoilt)
        if judged.ok:
            self.reached.add(index)
            self.write(events.WaypointEvent(index, target, pose))
        else:
            said = f"way-point {index} was reported but not reached: {judged.detail}"
            self.write(events.LogEvent(events.Level.WARNING, "journal", said))
        return judged

    def missed(self) -> str | None:
        """The way-points that a tree that succeeds has left out; None where every one was reached."""
        total = len(self._route) + 1
        missed = [str(index) for index in range(total) if index not in self.reached]
        if not missed:
            return None
        listed = f"; not way-point{'s'[: len(missed) > 1]} {', '.join(missed)}" if self.reached else ""
        return f"{len(self.reached)} of {total} way-points were reached{listed}"

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
