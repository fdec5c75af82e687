"""What became of each injected fault, from the record, in stages.

    armed       its onset came
    fired       it altered something: without that the run proves nothing about it
    observable  the executive first held measurement against prediction, or had a leaf fail, after that
    detected    the nominal hypothesis led no longer
    isolated    the hypothesis that the fault should lead to led
    recovered   the nominal led again

What comes more than DETECTION_GRACE_S after a passing fault is about something else.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from executive.record.events import (
    FaultArmedEvent,
    FaultEvent,
    HypothesesEvent,
    NodeChange,
)
from executive.record.history import At, History
from executive.record.run_result import FalseAlarm, FaultStages

NOMINAL = "nominal"
DETECTION_GRACE_S = 600.0


def fault_rows(history: History, world: History) -> tuple[FaultStages, ...]:
    """The stages of each injected fault, in the order of their onsets."""
    armed = history.all(FaultArmedEvent)
    changes = sorted(history.all(FaultEvent) + world.all(FaultEvent), key=lambda at: at.time_s)
    names = dict.fromkeys([at.event.name for at in armed] + [at.event.name for at in changes])
    return tuple(_stages(name, armed, changes, history) for name in names)


def _stages(
    name: str, armed: Sequence[At[FaultArmedEvent]], changes: Sequence[At[FaultEvent]], history: History
) -> FaultStages:
    onset = next((at for at in armed if at.event.name == name), None)
    on = next((at for at in changes if at.event.name == name and at.event.active), None)
    off = next((at for at in changes if at.event.name == name and not at.event.active), None)
    stages = FaultStages(
        name=name,
        cause=(onset.event.cause or None) if onset else None,
        fired=on is not None,
        t_armed_s=onset.time_s if onset else None,
    )
    if on is None:
        return stages
    until_s = off.time_s + DETECTION_GRACE_S if off else math.inf
    stages = replace(
        stages,
        t_on_s=on.time_s,
        t_off_s=off.time_s if off else None,
        expected=on.event.hypothesis or None,
    )
    return _answered(stages, history, on.time_s, until_s)


def _answered(stages: FaultStages, history: History, from_s: float, until_s: float) -> FaultStages:
    """The same with what the executive noticed, concluded and got over."""
    detected = next(iter(episodes(history, from_s, until_s)), None)
    isolated_s = first_leading(history, stages.expected or "", from_s, until_s)
    return replace(
        stages,
        t_observable_s=_observable_s(history, from_s),
        t_detected_s=detected.time_s if detected else None,
        t_isolated_s=isolated_s,
        hypothesis=stages.expected if isolated_s is not None else (detected.event if detected else None),
        t_recovered_s=first_leading(history, NOMINAL, detected.time_s) if detected else None,
    )


def _observable_s(history: History, from_s: float) -> float | None:
    checks = [at.time_s for at in history.all(HypothesesEvent) if at.time_s >= from_s]
    failed = [at.time_s for at in history.all(NodeChange) if at.event.reason and at.time_s >= from_s]
    return min(checks + failed, default=None)


def leading(event: HypothesesEvent) -> str | None:
    """The hypothesis with the largest weight, None if there are no weights."""
    return max(event.weights, key=event.weights.__getitem__, default=None)


def first_leading(
    history: History, hypothesis: str, from_s: float, until_s: float = math.inf
) -> float | None:
    """The first time from `from_s` to `until_s` when the hypothesis has the largest weight [s]."""
    for time_s, event in history.all(HypothesesEvent):
        if from_s <= time_s <= until_s and leading(event) == hypothesis:
            return time_s
    return None


def episodes(history: History, from_s: float = 0.0, until_s: float = math.inf) -> list[At[str]]:
    """Each time the nominal ceased to lead, and what led then."""
    found: list[At[str]] = []
    nominal = True
    for time_s, event in history.all(HypothesesEvent):
        if not from_s <= time_s <= until_s:
            continue
        leads = leading(event)
        if leads is not None and leads != NOMINAL and nominal:
            found.append(At(time_s, leads))
        nominal = leads == NOMINAL
    return found


def false_alarms(history: History, faults: Sequence[FaultStages]) -> tuple[FalseAlarm, ...]:
    """Episodes that no fault can have caused: before the first one took effect, all of them where none did.

    In a run without faults (the paired run) these are all of its alarms.
    """
    before_s = min((fault.t_on_s for fault in faults if fault.t_on_s is not None), default=math.inf)
    return tuple(FalseAlarm(at.time_s, at.event) for at in episodes(history) if at.time_s < before_s)
