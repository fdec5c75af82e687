"""When injected faults begin and end, judged once a tick from what the record is told."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from executive.fault_entries import ResolvedFault
from executive.faults import Fault, Trigger
from executive.journal import RunJournal
from executive.ports import Backend, Devices
from executive.telemetry import events
from executive.types import Segment


class Sightings:
    """What has happened so far, as far as triggers ask for it; fed with every event of the record.

    A node counts as entered each time it is seen running anew, or ends at once. Nodes are called by the
    last part of their path; `#2` and the like behind it count together.
    """

    def __init__(self) -> None:
        self.entered: Counter[str] = Counter()
        self.strategies: set[str] = set()
        self.waypoints: set[int] = set()
        self._running: set[str] = set()

    def hear(self, event: object) -> None:
        if isinstance(event, events.NodeChange):
            self._node(event)
        elif isinstance(event, events.StrategyEvent):
            self.strategies.add(event.name)
        elif isinstance(event, events.WaypointEvent):
            self.waypoints.add(event.index)

    def _node(self, change: events.NodeChange) -> None:
        runs = change.status == "running"
        if change.path not in self._running and change.status != "invalid":
            self.entered[change.path.rsplit("/", 1)[-1].split("#")[0]] += 1
        (self._running.add if runs else self._running.discard)(change.path)


@dataclass
class Injection:
    """One fault of the scenario under way: not yet, active since, or over."""

    plan: ResolvedFault
    fault: Fault
    since_s: float | None = None
    fired: bool = False
    over: bool = False

    def active(self) -> bool:
        return self.since_s is not None and not self.over


class FaultSchedule:
    """Makes the scenario's faults, wraps the devices with them, and starts and ends each in its time.

    FaultEvents are written when a fault has taken effect, not when it was asked to; one that never did is
    evidence that the run tested nothing.
    """

    def __init__(self, plans: Sequence[ResolvedFault], backend: Backend) -> None:
        self._backend = backend
        self._injections = [Injection(plan, plan.spec.make(plan.parameters)) for plan in plans]
        self.sightings = Sightings()

    def wrap(self, devices: Devices) -> Devices:
        """The devices behind every fault of the ports; the first fault of the scenario lies innermost."""
        for injection in self._injections:
            devices = injection.fault.wrap(devices, injection.active)
        return devices

    def tick(self, journal: RunJournal, route: Sequence[Segment]) -> None:
        """Begin what is due, note what took effect, end what has lasted long enough."""
        if not self._injections:
            return
        now_s = self._backend.clock.now_s
        progress = journal.along_route_m() / sum(segment.length_m for segment in route)
        for injection in self._injections:
            if injection.since_s is None and _due(injection.plan.start, self.sightings, now_s, progress):
                injection.since_s = now_s
                injection.fault.apply(self._backend, True)
            if injection.active():
                self._go_on(injection, journal, now_s)

    def never_fired(self) -> tuple[str, ...]:
        """The faults that have not taken effect."""
        return tuple(i.plan.name for i in self._injections if not i.fired)

    def conclude(self, journal: RunJournal) -> str | None:
        """At the end of the run: note the last effects; why the run is invalid, None if it is not."""
        for injection in self._injections:
            self._note_effect(injection, journal)
        missing = self.never_fired()
        for name in missing:
            journal.write(events.FaultEvent(name, False))
        return f"{', '.join(missing)} never took effect" if missing else None

    def _go_on(self, injection: Injection, journal: RunJournal, now_s: float) -> None:
        self._note_effect(injection, journal)
        lasts_s, since_s = injection.plan.duration_s, injection.since_s
        if lasts_s is None or since_s is None or now_s - since_s < lasts_s:
            return
        injection.over = True
        injection.fault.apply(self._backend, False)
        if injection.fired:
            journal.write(events.FaultEvent(injection.plan.name, False, injection.plan.spec.hypothesis))

    @staticmethod
    def _note_effect(injection: Injection, journal: RunJournal) -> None:
        if injection.active() and not injection.fired and injection.fault.took_effect():
            injection.fired = True
            journal.write(events.FaultEvent(injection.plan.name, True, injection.plan.spec.hypothesis))


def _due(start: Trigger, seen: Sightings, now_s: float, progress: float) -> bool:
    if start.time is not None:
        return now_s >= start.time
    if start.progress is not None:
        return progress >= start.progress
    if start.waypoint is not None:
        return start.waypoint in seen.waypoints
    if start.node is not None:
        return seen.entered[start.node] >= (start.count or 1)
    return start.strategy in seen.strategies
