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

from executive.record.events import (
    FaultArmedEvent,
    FaultEvent,
    HypothesesEvent,
    NodeChange,
)
from executive.record.history import At, History

NOMINAL = "nominal"
DETECTION_GRACE_S = 600.0

Row = dict[str, object]


def fault_rows(history: History, world: History) -> list[Row]:
    """One row per injected fault, in the order of their onsets; times [s], None where a stage never came."""
    armed = history.all(FaultArmedEvent)
    told = sorted(history.all(FaultEvent) + world.all(FaultEvent), key=lambda at: at.time_s)
    names = dict.fromkeys([at.event.name for at in armed] + [at.event.name for at in told])
    return [_row(name, armed, told, history) for name in names]


def _row(
    name: str, armed: Sequence[At[FaultArmedEvent]], told: Sequence[At[FaultEvent]], history: History
) -> Row:
    onset = next((at for at in armed if at.event.name == name), None)
    on = next((at for at in told if at.event.name == name and at.event.active), None)
    off = next((at for at in told if at.event.name == name and not at.event.active), None)
    row: Row = {
        "name": name,
        "cause": (onset.event.cause or None) if onset else None,
        "fired": on is not None,
        "t_armed_s": onset.time_s if onset else None,
        "t_on_s": on.time_s if on else None,
        "t_off_s": off.time_s if on and off else None,
        "t_observable_s": None,
        "t_detected_s": None,
        "t_isolated_s": None,
        "hypothesis": None,
        "expected": (on.event.hypothesis or None) if on else None,
        "t_recovered_s": None,
    }
    if on is None:
        return row
    until_s = off.time_s + DETECTION_GRACE_S if off else math.inf
    return row | _answer(history, on.time_s, until_s, on.event.hypothesis)


def _answer(history: History, from_s: float, until_s: float, expected: str) -> Row:
    """What the executive noticed, concluded and got over."""
    detected = next(iter(episodes(history, from_s, until_s)), None)
    isolated_s = first_leading(history, expected, from_s, until_s)
    recovered_s = first_leading(history, NOMINAL, detected.time_s) if detected else None
    concluded = detected.event if detected else None
    return {
        "t_observable_s": _observable_s(history, from_s),
        "t_detected_s": detected.time_s if detected else None,
        "t_isolated_s": isolated_s,
        "hypothesis": expected if isolated_s is not None else concluded,
        "t_recovered_s": recovered_s,
    }


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


def false_alarms(history: History, rows: Sequence[Row]) -> list[Row]:
    """Episodes that no fault can have caused: before the first one took effect, all of them where none did.

    In a run without faults (the paired run) these are all of its alarms.
    """
    fired = [row["t_on_s"] for row in rows if isinstance(row["t_on_s"], float)]
    before_s = min(fired, default=math.inf)
    return [{"t_s": at.time_s, "hypothesis": at.event} for at in episodes(history) if at.time_s < before_s]
