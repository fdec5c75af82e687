"""When injected faults begin and end, judged once a tick from what the record is told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from executive.core.chance import generator
from executive.core.ports import Backend, Devices, Localizer
from executive.core.types import Segment
from executive.inject.entries import ResolvedFault
from executive.inject.faults import Cue, Fault, TreeParts
from executive.inject.onsets import Onset, Sightings
from executive.inject.profiles import Shape
from executive.pool import Strategy
from executive.record import events
from executive.record.journal import RunJournal


@dataclass
class Level:
    """How strong a fault is just now, 0 to 1; set by the schedule, asked by what is wrapped."""

    now: float = 0.0

    def __call__(self) -> float:
        return self.now


@dataclass
class Injection:
    """One fault of the scenario under way: waiting, armed since its onset, fired on its effect, over."""

    plan: ResolvedFault
    fault: Fault
    cue: Cue
    onset: Onset
    shape: Shape
    level: Level
    since_s: float | None = None
    fired: bool = False
    over: bool = False


class FaultSchedule:
    """Makes the scenario's faults, wraps what they act through, and starts and ends each in its time.

    A FaultEvent is written when a fault has taken effect, not when it was asked to; one that never did is
    evidence that the run tested nothing.
    """

    def __init__(self, plans: Sequence[ResolvedFault], backend: Backend, seed: int) -> None:
        self._backend = backend
        self._injections = [self._injection(plan, seed) for plan in plans]
        self.sightings = Sightings()

    def _injection(self, plan: ResolvedFault, seed: int) -> Injection:
        level = Level()
        cue = Cue(level, self._backend.clock, generator(seed, f"fault {plan.name}"))
        shape = Shape(plan.profile, generator(seed, f"profile {plan.cause or plan.name}"))
        return Injection(plan, plan.spec.make(plan.parameters), cue, Onset(plan.start), shape, level)

    def wrap(self, devices: Devices) -> Devices:
        """The devices behind every fault of the ports; the first fault of the scenario lies innermost."""
        for injection in self._injections:
            devices = injection.fault.wrap(devices, injection.cue)
        return devices

    def wrap_localizer(self, localizer: Localizer) -> Localizer:
        """The localizer behind every fault of estimation."""
        for injection in self._injections:
            localizer = injection.fault.wrap_localizer(localizer, injection.cue)
        return localizer

    def wrap_pool(self, strategies: tuple[Strategy, ...]) -> tuple[Strategy, ...]:
        """The strategies that are found with these faults."""
        for injection in self._injections:
            strategies = injection.fault.wrap_pool(strategies, injection.cue)
        return strategies

    def wrap_tree(self, tree: TreeParts) -> None:
        """Put the executive's own faults into the built tree."""
        for injection in self._injections:
            injection.fault.wrap_tree(tree, injection.cue)

    def tick(self, journal: RunJournal, route: Sequence[Segment]) -> None:
        """Begin what is due, let levels follow their profiles, note what took effect, end what has lasted."""
        if not self._injections:
            return
        now_s = self._backend.clock.now_s
        waiting = any(injection.since_s is None for injection in self._injections)
        progress = journal.along_route_m() / sum(s.length_m for s in route) if waiting else 1.0
        for injection in self._injections:
            if injection.since_s is None and injection.onset.due(self.sightings, now_s, progress):
                injection.since_s = now_s
                journal.write(events.FaultArmedEvent(injection.plan.name, injection.plan.cause or ""))
            if injection.since_s is not None and not injection.over:
                self._go_on(injection, journal, now_s - injection.since_s)

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

    def _go_on(self, injection: Injection, journal: RunJournal, since_s: float) -> None:
        lasts_s = injection.plan.duration_s
        injection.over = lasts_s is not None and since_s >= lasts_s
        if injection.over:
            self._note_effect(injection, journal)
        level = 0.0 if injection.over else injection.shape.level(since_s)
        if level != injection.level.now:
            injection.level.now = level
            injection.fault.apply(self._backend, level)
        if level > 0.0:
            injection.fault.watch(self._backend)
            self._note_effect(injection, journal)
        if injection.over and injection.fired:
            journal.write(events.FaultEvent(injection.plan.name, False, injection.plan.spec.hypothesis))

    @staticmethod
    def _note_effect(injection: Injection, journal: RunJournal) -> None:
        if injection.since_s is not None and not injection.fired and injection.fault.took_effect():
            injection.fired = True
            journal.write(events.FaultEvent(injection.plan.name, True, injection.plan.spec.hypothesis))
