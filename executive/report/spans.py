"""Stretches of mission time: what each leaf was doing, which strategy or fault was active."""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

from executive.record.events import NodeChange
from executive.report.gather import RecordedRun
from executive.tree.catalogue import control_types


class Span(NamedTuple):
    """From one mission time to another [s], with a kind that gives the colour and words for hovering."""

    start_s: float
    end_s: float
    kind: str
    words: str


def leaf_spans(run: RecordedRun) -> dict[str, list[Span]]:
    """Per leaf path, in order of first entry: the stretches it ran, each with how it ended.

    A leaf is a node that no other node of the record lies under. One that ended within the tick in which
    it began has a span of no length.
    """
    changes = run.history.all(NodeChange)
    inner = {
        path.rsplit("/", n)[0]
        for path in {c.event.path for c in changes}
        for n in range(1, path.count("/") + 1)
    }
    begun: dict[str, float] = {}
    spans: dict[str, list[Span]] = defaultdict(list)
    for time_s, change in changes:
        if change.path in inner:
            continue
        if change.status == "running":
            begun.setdefault(change.path, time_s)
            spans[change.path] = spans[change.path]
            continue
        start = begun.pop(change.path, time_s)
        why = " ".join(word for word in (change.status, change.reason, change.detail) if word)
        spans[change.path].append(Span(start, time_s, change.status, why))
    for path, start in begun.items():
        spans[path].append(Span(start, run.end_s, "running", "under way at the end of the record"))
    return dict(spans)


def strategy_spans(run: RecordedRun) -> dict[str, list[Span]]:
    """Per strategy: from its choice to its verdict."""
    spans: dict[str, list[Span]] = defaultdict(list)
    for row in run.result.strategies:
        end_s = run.end_s if row.t_end_s is None else row.t_end_s
        helped = {True: "helped", False: "did not help", None: "verdict still out"}[row.helped]
        words = f"against {row.hypothesis} ({row.weight:.2f}): {helped}"
        spans[row.name].append(Span(row.t_s, end_s, "strategy", words))
    return dict(spans)


def fault_spans(run: RecordedRun) -> dict[str, list[Span]]:
    """Per injected fault: while it was in effect."""
    spans: dict[str, list[Span]] = {}
    for row in run.result.faults:
        if row.t_on_s is not None:
            end_s = run.end_s if row.t_off_s is None else row.t_off_s
            spans[row.name] = [Span(row.t_on_s, end_s, "fault", "in effect")]
    return spans


def short_names(paths: list[str]) -> dict[str, str]:
    """The last name of each path, with as many of its parents as tell it from the others.

    Composites that carry only their type's name tell nothing, so trees and named nodes stand for them.
    """
    telling = {path: telling_parts(path.split("/")) for path in paths}
    names: dict[str, str] = {}
    for path, parts in telling.items():
        for n in range(1, len(parts) + 1):
            tail = parts[-n:]
            if sum(other[-n:] == tail for other in telling.values()) == 1:
                break
        names[path] = "/".join(tail) if list(telling.values()).count(parts) == 1 else path
    return names


def telling_parts(parts: list[str]) -> list[str]:
    """The steps that tell something: what is done for each of several tells itself from what is done once."""
    silent = {name for name, kind in control_types().items() if not kind.names_an_item}
    kept = [part for part in parts[:-1] if part.split("#")[0] not in silent]
    return [*kept, parts[-1]]
