"""Whether a fault's time has come, judged from what the record is told."""

from __future__ import annotations

from collections import Counter

from executive.core.types import Call
from executive.record import events, listener, live_types
from executive.tree.addresses import matches
from executive.tree.expressions.guards import parse_guard
from proving.inject.triggers import Trigger


class Sightings:
    """What has happened so far, as far as triggers ask for it; fed with every event of the record.

    A node counts as entered each time it is seen running anew, or ends at once; `entered` has its path.
    """

    def __init__(self) -> None:
        self.entered: Counter[tuple[str, str]] = Counter()
        self.waypoints: set[int] = set()
        self.values: dict[str, float] = {}
        self._heard = listener()
        self._running: set[str] = set()

    def hear(self, event: object) -> None:
        self.values.update(self._heard(event))
        if isinstance(event, events.NodeChange):
            self._node(event)
        elif isinstance(event, events.StrategyEvent) and event.verdict is events.Verdict.CHOSEN:
            self.entered["strategy", event.name] += 1
            self.entered["phase", "recovering"] += 1
        elif isinstance(event, events.WaypointEvent):
            self.waypoints.add(event.index)
        elif isinstance(event, events.Command) and (phase := _phase(event)):
            self.entered["phase", phase] += 1
        elif isinstance(event, Call):
            self.entered["phase", "calling"] += 1

    def _node(self, change: events.NodeChange) -> None:
        runs = change.status == "running"
        if change.path not in self._running and change.status != "invalid":
            self.entered["node", change.path] += 1
        (self._running.add if runs else self._running.discard)(change.path)


def _phase(command: events.Command) -> str | None:
    if command.verb == "drive" and {"left_m", "right_m"} <= command.values.keys():
        return "driving" if command.values["left_m"] * command.values["right_m"] >= 0.0 else "turning"
    return "localising" if command.device == "cameras" else None


class Onset:
    """One trigger under way; ask once a tick."""

    def __init__(self, trigger: Trigger) -> None:
        self._trigger = trigger
        self._condition = None if trigger.when is None else parse_guard(trigger.when, live_types())
        self._was: bool | None = None
        self._since_s: float | None = None

    def due(self, seen: Sightings, now_s: float, progress: float) -> bool:
        """Whether it is time; an unknown condition (a signal without a value yet) does not hold."""
        t = self._trigger
        if t.time is not None:
            return now_s >= t.time
        if t.progress is not None:
            return progress >= t.progress
        if t.waypoint is not None:
            return t.waypoint in seen.waypoints
        if self._condition is not None:
            return self._held(self._condition.holds(lambda name, _: seen.values.get(name)), now_s)
        return self._entered(seen) >= (t.count or 1)

    def _entered(self, seen: Sightings) -> int:
        """How often that has been entered which the trigger waits for."""
        t = self._trigger
        if t.node is not None:
            return sum(
                n for (kind, path), n in seen.entered.items() if kind == "node" and matches(t.node, path)
            )
        kind = "strategy" if t.strategy is not None else "phase"
        return seen.entered[kind, str(getattr(t, kind))]

    def _held(self, known: bool | None, now_s: float) -> bool:
        """A condition as it is, or its edge; true from then on for as long as `held` asks."""
        edge, held_s = self._trigger.edge, self._trigger.held or 0.0
        holds = known is True if edge != "fall" else known is False
        turned = self._was is not None and known is not None and known is not self._was
        if not holds:
            self._since_s = None
        elif self._since_s is None and (edge is None or turned):
            self._since_s = now_s
        self._was = known if known is not None else self._was
        return self._since_s is not None and now_s - self._since_s >= held_s
