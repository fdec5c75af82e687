"""What nodes did in a run, and expectations of it: in which order they ended, how often, and how never.

A node ends by success, by failure (which also goes by its reason) or halted. Nodes that end in one tick may
be named in any order.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from executive.record import History, JudgedRow, row
from executive.record.events import NodeChange
from executive.tree.addresses import matches
from proving.judge.expect import Times

FAILURE, HALTED = "failure", "halted"


@dataclass(frozen=True)
class End:
    """One end of one node: the words that it goes by."""

    time_s: float
    path: str
    words: frozenset[str]

    def is_of(self, step: Mapping[str, str]) -> bool:
        """Whether this is what a step of a scenario speaks of."""
        (address, word), *_ = step.items()
        return word in self.words and matches(address, self.path)


def ends(history: History) -> list[End]:
    """Every end of every node, in the order of the record."""
    return list(_ends(history))


def _ends(history: History) -> Iterator[End]:
    running: set[str] = set()
    for time_s, change in history.all(NodeChange):
        if change.status == "running":
            running.add(change.path)
            continue
        if change.status != "invalid":
            yield End(time_s, change.path, frozenset({change.status, change.reason} - {""}))
        elif change.path in running:
            yield End(time_s, change.path, frozenset({HALTED}))
        running.discard(change.path)


def in_order(steps: Sequence[Mapping[str, str]], seen: Sequence[End], end_s: float) -> Iterator[JudgedRow]:
    """A row a step: met if it came after the step before it, or in its tick. None is, after one missed."""
    left, since_s, missed = list(seen), 0.0, False
    for number, step in enumerate(steps, start=1):
        text = f"step {number}: {told(step)}"
        found = None if missed else next((e for e in left if e.time_s >= since_s and e.is_of(step)), None)
        if found is None:
            missed = True
            yield row(text, False, t_violation_s=end_s)
            continue
        left.remove(found)
        since_s = found.time_s
        yield row(text, True)


def never(steps: Sequence[Mapping[str, str]], seen: Sequence[End]) -> Iterator[JudgedRow]:
    """A row a step: met if it never came."""
    for step in steps:
        first_s = next((end.time_s for end in seen if end.is_of(step)), None)
        yield row(f"never {told(step)}", first_s is None, t_violation_s=first_s)


def times(wanted: Sequence[Times], seen: Sequence[End], end_s: float) -> Iterator[JudgedRow]:
    """A row each: met if it came as often as is allowed."""
    for each in wanted:
        came_s = [end.time_s for end in seen if end.is_of(each.of)]
        least, most = each.at_least, each.at_most
        bounds = [f"at least {least}"] * (least > 0) + [f"at most {most}"] * (most is not None)
        noun = "time" if (most if most is not None else least) == 1 else "times"
        spare = min(len(came_s) - least, len(came_s) if most is None else most - len(came_s))
        too_many = most is not None and len(came_s) > most
        at_s = came_s[most] if too_many and most is not None else end_s
        yield row(f"{told(each.of)} {' and '.join(bounds)} {noun}", spare >= 0, spare, "", at_s)


def told(step: Mapping[str, str]) -> str:
    """A step in words."""
    return ", ".join(f"{address} {word}" for address, word in step.items())
