"""Mission time as integer ticks, and the only place where the wall clock is read."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field


@dataclass
class Clock:
    """Mission clock: an integer count of ticks of a fixed length. Nothing else tells the time."""

    tick_s: float = 1.0
    ticks: int = 0

    @property
    def now_s(self) -> float:
        """Mission time [s], exactly `ticks * tick_s`."""
        return self.ticks * self.tick_s

    def advance(self) -> None:
        """Let one tick pass."""
        self.ticks += 1

    def ticks_for(self, duration_s: float) -> int:
        """Whole ticks that last at least `duration_s` (0 for a duration of 0 or less)."""
        whole = round(duration_s / self.tick_s, 9)
        return max(0, -int(-whole // 1))


@dataclass
class Stopwatch:
    """Wall time spent per part of a run [s]; figures for people, never an input to behaviour."""

    spent_s: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    _started: float = field(default_factory=time.perf_counter)

    @contextmanager
    def measure(self, part: str) -> Iterator[None]:
        """Add the wall time of the `with` block to `part`; nested blocks each count their own."""
        begin = time.perf_counter()
        try:
            yield
        finally:
            self.spent_s[part] += time.perf_counter() - begin

    def elapsed_s(self) -> float:
        """Wall time since this stopwatch was made [s]."""
        return time.perf_counter() - self._started
