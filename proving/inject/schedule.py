"""When injected faults begin and end, judged once a tick from what the record is told."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from executive.core.chance import generator
from executive.core.ports import Devices, Localizer
from executive.pool import Strategy
from executive.record import events
from executive.run import Context, Cue, Fault, Instrument, TreeParts
from proving.inject.entries import ResolvedFault
from proving.inject.onsets import Onset, Sightings
from proving.inject.profiles import Shape

SEEN_M = 0.02  # what has moved by less is not written again


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
    placed: tuple[events.Placed, ...] = ()
    fired: bool = False
    over: bool = False


class FaultSchedule(Instrument):
    """Makes the scenario's faults, wraps what they act through, and starts and ends each in its time.

    A FaultEvent is written when a fault has taken effect, not when it was asked to; one that never did is
    evidence that the run tested nothing.
    """

    def __init__(self, plans: Sequence[ResolvedFault], context: Context) -> None:
        self._backend, self._write, self._progress = context.backend, context.write, context.progress
        self._injections = [self._injection(plan, context.seed) for plan in plans]
        self._seen = Sightings()

    def _injection(self, plan: ResolvedFault, seed: int) -> Injection:
        level = Level()
        cue = Cue(level, self._backend.clock, generator(seed, f"fault {plan.name}"))
        shape = Shape(plan.profile, generator(seed, f"profile {plan.cause or plan.name}"))
        return Injection(plan, plan.spec.make(plan.parameters), cue, Onset(plan.start), shape, level)

    def wrap_devices(self, devices: Devices) -> Devices:
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

    def hear(self, event: object) -> None:
        self._seen.hear(event)

    def tick(self, now_s: float) -> None:
        """Begin what is due, let levels follow their profiles, note what took effect, end what has lasted."""
        waiting = any(injection.since_s is None for injection in self._injections)
        progress = self._progress() if waiting else 1.0
        for injection in self._injections:
            if injection.since_s is None and injection.onset.due(self._seen, now_s, progress):
                injection.since_s = now_s
                self._write(events.FaultArmedEvent(injection.plan.name, injection.plan.cause or ""))
            if injection.since_s is not None and not injection.over:
                self._go_on(injection, now_s - injection.since_s)

    def conclude(self) -> str | None:
        """At the end of the run: note the last effects; why the run is invalid, None if it is not."""
        for injection in self._injections:
            self._note_effect(injection)
        missing = [i.plan.name for i in self._injections if not i.fired]
        for name in missing:
            self._write(events.FaultEvent(name, False))
        return f"{', '.join(missing)} never took effect" if missing else None

    def _go_on(self, injection: Injection, since_s: float) -> None:
        lasts_s = injection.plan.duration_s
        injection.over = lasts_s is not None and since_s >= lasts_s
        if injection.over:
            self._note_effect(injection)
        level = 0.0 if injection.over else injection.shape.level(since_s)
        if level != injection.level.now:
            injection.level.now = level
            injection.fault.apply(self._backend, level)
        if level > 0.0:
            injection.fault.watch(self._backend)
            self._note_effect(injection)
        self._note_places(injection)
        if injection.over and injection.fired:
            self._write(events.FaultEvent(injection.plan.name, False, injection.plan.spec.hypothesis))

    def _note_effect(self, injection: Injection) -> None:
        if injection.since_s is not None and not injection.fired and injection.fault.took_effect():
            injection.fired = True
            self._write(events.FaultEvent(injection.plan.name, True, injection.plan.spec.hypothesis))

    def _note_places(self, injection: Injection) -> None:
        """Write what it has placed, again once that has moved by enough to be seen on a map."""
        placed = injection.fault.placed()
        if _differ(placed, injection.placed):
            injection.placed = placed
            self._write(events.PlacedEvent(injection.plan.name, placed))


def _differ(here: Sequence[events.Placed], there: Sequence[events.Placed]) -> bool:
    if [(a.kind, a.radius_m) for a in here] != [(b.kind, b.radius_m) for b in there]:
        return True
    moved = (math.dist((a.x_m, a.y_m), (b.x_m, b.y_m)) for a, b in zip(here, there, strict=True))
    return any(distance_m >= SEEN_M for distance_m in moved)
