"""Trials: each runs case after case, the next depending on how the last one ended; many go on at once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from typing import Generic, TypeVar

from proving.engine import Case, Ending, run_cases

T = TypeVar("T")
Trial = Generator[Case, Ending, T]
"""Yields a case, is sent its end, and so on; returns what it found out."""

Run = Callable[[Iterable[Case], int], Iterator[Ending]]


def conduct(trials: Iterable[Trial[T]], slots: int, run: Run = run_cases) -> Iterator[T]:
    """What each trial found out, in the order in which they come to an end. Keys of cases must differ.

    `trials` is asked anew after each end, so that an iterator may have none now and some later.
    """
    desk: _Desk[T] = _Desk(trials)
    ends = run(desk, slots)
    try:
        for ended in ends:
            desk.tell(ended)
            yield from desk.take_found()
    finally:
        if isinstance(ends, Generator):
            ends.close()
    yield from desk.take_found()


class _Desk(Generic[T]):
    """An iterator that hands out the next case of any trial; it may have none now and some later."""

    def __init__(self, trials: Iterable[Trial[T]]) -> None:
        self.fresh = iter(trials)
        self.ready: deque[tuple[Case, Trial[T]]] = deque()
        self.under_way: dict[str, Trial[T]] = {}
        self.found: list[T] = []

    def __iter__(self) -> _Desk[T]:
        return self

    def __next__(self) -> Case:
        while not self.ready:
            self.advance(next(self.fresh), None)
        case, trial = self.ready.popleft()
        self.under_way[case.key] = trial
        return case

    def tell(self, ended: Ending) -> None:
        self.advance(self.under_way.pop(ended.case.key), ended)

    def advance(self, trial: Trial[T], ended: Ending | None) -> None:
        """Let a trial go on to its next case, or to its end."""
        try:
            case = next(trial) if ended is None else trial.send(ended)
        except StopIteration as end:
            self.found.append(end.value)
        else:
            self.ready.append((case, trial))

    def take_found(self) -> list[T]:
        found, self.found = self.found, []
        return found
