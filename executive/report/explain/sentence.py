"""A run in one sentence, from its record: what came up, what was concluded and tried, and how it ended."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TypeVar

from executive.record import History
from executive.record.events import (
    FaultEvent,
    HypothesesEvent,
    LogEvent,
    NodeChange,
    Resumed,
    RouteEvent,
    Stop,
    StrategyEvent,
    Verdict,
    WaypointEvent,
)
from executive.record.evidence import NOMINAL, leading
from executive.record.history import At
from executive.record.result import strategy_rows
from executive.report.explain.chain import ChainLink, Moment
from executive.report.figure import counted, duration

T = TypeVar("T")
POOL = "pool"
"""The part that says in the log that no strategy fitted."""
_MOST_NAMED, _MOST_DETAIL = 3, 60
_ENDS = {
    "safe_hold": "the rover was stopped safely",
    "help": "the rover stopped and called home",
    "time_limit": "the time limit came",
    "invalid": "the run proved nothing",
    "error": "a defect ended the run",
}


def sentence(history: History, at_s: float | None = None) -> str:
    """What happened up to a mission time [s], by default to the end of the record."""
    end_s = history.end_s if at_s is None else at_s
    parts = [*_came_up(history, end_s), *_concluded(history, end_s), *_tried(history, end_s)]
    stop = _stop(history, end_s)
    nothing = "nothing came up" if stop is None or stop.outcome == "reached" else "no failure was recorded"
    words = "; ".join([*(parts or [nothing]), _ended(history, end_s)])
    return words[0].upper() + words[1:] + "."


def _came_up(history: History, end_s: float) -> Iterator[str]:
    """The faults that took effect, and the failures that the pool was asked about or that ended the run."""
    injected = dict.fromkeys(
        at.event.name for at in _until(history.all(FaultEvent), end_s) if at.event.active
    )
    if injected:
        yield f"injected {'fault' if len(injected) == 1 else 'faults'} {_named(injected)} took effect"
    cuts = [duration(time_s) for time_s, _ in _until(history.all(Resumed), end_s)]
    if cuts:
        yield f"the run was cut off and went on at {_named(cuts)}"
    failures = _failures(history, end_s)
    if failures:
        first = failures[0]
        why = first.detail if first.detail and len(first.detail) <= _MOST_DETAIL else ""
        said = ", ".join(word for word in (first.reason.replace("_", " "), why) if word)
        more = f", and {counted(len(failures) - 1, 'more failure')} after it" if len(failures) > 1 else ""
        yield f"{first.name} failed at {duration(first.since_s)}{f' ({said})' if said else ''}{more}"


def _failures(history: History, end_s: float) -> list[ChainLink]:
    """The leaf behind each question to the pool, and behind an end that was not good; each failure once."""
    changes = history.all(NodeChange)
    chosen = _until(history.all(StrategyEvent), end_s)
    asked = {time_s for time_s, event in chosen if event.verdict is Verdict.CHOSEN}
    asked |= {at.time_s for at in _until(history.all(LogEvent), end_s) if at.event.name == POOL}
    chains = [Moment(changes, time_s).failure([time_s]) for time_s in sorted(asked)]
    stop = _stop(history, end_s)
    if not asked and stop is not None and stop.outcome != "reached":
        chains.append(Moment(changes, end_s).failure())
    found = {(chain[0].path, chain[0].since_s): chain[0] for chain in chains if chain}
    return list(found.values())


def _concluded(history: History, end_s: float) -> Iterator[str]:
    """What was held likeliest where the pool was asked; else what leads at the end, if it is not nominal."""
    weights: dict[str, float] = {}
    for _, event in _until(history.all(StrategyEvent), end_s):
        weights[event.hypothesis] = max(event.weight, weights.get(event.hypothesis, 0.0))
    weighed = _until(history.all(HypothesesEvent), end_s)
    leads = leading(weighed[-1].event) if weighed else None
    if not weights and leads is not None and leads != NOMINAL:
        weights[leads] = weighed[-1].event.weights[leads]
    if weights:
        named = _named(f"{name} (weight {weight:.2f})" for name, weight in weights.items())
        yield f"{named} {_was(weights)} concluded"


def _tried(history: History, end_s: float) -> Iterator[str]:
    """What the strategies came to, each named once, and whether the pool had none to offer."""
    rows = strategy_rows(History.holding(_until(history.all(StrategyEvent), end_s)))
    verdicts: dict[str, list[bool | None]] = {}
    for row in rows:
        verdicts.setdefault(row.name, []).append(row.helped)
    helped = [name for name, all_of in verdicts.items() if True in all_of]
    open_yet = [name for name, all_of in verdicts.items() if True not in all_of and None in all_of]
    vain = [name for name in verdicts if name not in (*helped, *open_yet)]
    if vain:
        yield f"{_named(vain)} did not help"
    if helped:
        yield f"{_named(helped)} helped"
    if open_yet:
        yield f"{_named(open_yet)} {_was(open_yet)} begun"
    if any(at.event.name == POOL for at in _until(history.all(LogEvent), end_s)):
        yield "then no strategy fitted" if rows else "no strategy fitted"


def _ended(history: History, end_s: float) -> str:
    stop, places = _stop(history, end_s), _places(history, end_s)
    after = f"after {duration(end_s)}"
    if stop is None:
        cut = "the record breaks off" if end_s >= history.end_s else "the run was under way"
        return f"{cut} {after}{f', {places}' if places else ''}"
    if stop.outcome == "reached":
        return f"the goal was reached {after}{f', {places}' if places else ''}"
    ended = _ENDS.get(stop.outcome, f"it ended as {stop.outcome.replace('_', ' ')}")
    reason = f": {stop.reason}" if stop.reason and stop.outcome in ("invalid", "error") else ""
    return f"{ended} {after}{f', {places}' if places else ''}{reason}"


def _places(history: History, end_s: float) -> str:
    """How many way-points were reached, of how many; nothing where no route was recorded."""
    route = history.last(RouteEvent)
    if route is None:
        return ""
    reached = {at.event.index for at in _until(history.all(WaypointEvent), end_s)}
    return f"{len(reached)} of {counted(len(route.event.segments) + 1, 'way-point')} reached"


def _stop(history: History, end_s: float) -> Stop | None:
    found = history.last(Stop)
    return found.event if found is not None and found.time_s <= end_s else None


def _was(things: Sequence[str] | dict[str, float]) -> str:
    return "was" if len(things) == 1 else "were"


def _named(names: Iterable[str]) -> str:
    """`a`, `a and b`, `a, b and 3 more`."""
    every = list(names)
    if len(every) > _MOST_NAMED:
        every = [*every[: _MOST_NAMED - 1], f"{len(every) - _MOST_NAMED + 1} more"]
    return " and ".join(filter(None, (", ".join(every[:-1]), every[-1])))


def _until(events: Sequence[At[T]], end_s: float) -> list[At[T]]:
    return [at for at in events if at.time_s <= end_s]
