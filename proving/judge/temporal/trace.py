"""Signals of a recorded run on one grid of times: the union of all their samples, the start, and the end.

A signal keeps the value of a sample until its next one; before its first it is unknown (NaN). Of several
samples at one time the last counts. Times are whole nanoseconds, so that a bound of a formula meets a sample
exactly or not at all.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from executive.record import History
from executive.record.signals import signals
from proving.judge.temporal.formula import Bounds
from proving.judge.temporal.windows import Indices

Samples = tuple[Array, Array]
"""Times [s], ascending, and values (SI; a flag as 0 or 1), both of shape (m,)."""


@dataclass(frozen=True, eq=False)
class SignalTrace:
    """`times_ns` (n,), ascending; `values` by name, each (n,). `silent`: the signals without any sample."""

    times_ns: NDArray[np.int64]
    values: Mapping[str, Array]
    silent: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        return len(self.times_ns)

    @cached_property
    def end_ns(self) -> int:
        return int(self.times_ns[-1])

    def window(self, bounds: Bounds) -> tuple[Indices, Indices]:
        """First and last sample in force from `bounds.first_ns` to `bounds.last_ns` after each sample.

        What lies beyond the end is left out: a window that lies there entirely is empty (last < first).
        """
        opens_ns = self.times_ns + bounds.first_ns
        first = np.searchsorted(self.times_ns, opens_ns, side="right") - 1
        first = np.where(opens_ns > self.end_ns, self.count, first)
        if bounds.last_ns is None:
            return first, np.full(self.count, self.count - 1)
        return first, np.searchsorted(self.times_ns, self.times_ns + bounds.last_ns, side="right") - 1


def on_one_grid(samples: Mapping[str, Samples], end_s: float) -> SignalTrace:
    """The trace of these signals from mission time 0 to `end_s`, or to the last sample if that is later."""
    sampled = {name: _latest(times_s, values) for name, (times_s, values) in samples.items()}
    ends = np.array([0, round(end_s * 1e9)], dtype=np.int64)
    grid = np.unique(np.concatenate([ends, *(times_ns for times_ns, _ in sampled.values())]))
    values = {name: _held(grid, *sample) for name, sample in sampled.items()}
    return SignalTrace(
        grid, values, tuple(name for name, (times_ns, _) in sampled.items() if not len(times_ns))
    )


def recorded(names: Iterable[str], history: History, world: History) -> SignalTrace:
    """The named signals of a run: from its record, and from the simulator's own for those of the truth."""
    samples = {name: _samples(name, world if signals()[name].truth else history) for name in names}
    return on_one_grid(samples, history.end_s)


def _samples(name: str, history: History) -> Samples:
    signal = signals()[name]
    told = [(at.time_s, signal.read(at.event)) for kind in signal.events for at in history.all(kind)]
    given = sorted(((t, value) for t, value in told if value is not None), key=lambda sample: sample[0])
    return np.array([t for t, _ in given], dtype=np.float64), np.array(
        [v for _, v in given], dtype=np.float64
    )


def _latest(times_s: Array, values: Array) -> tuple[NDArray[np.int64], Array]:
    times_ns = np.round(np.asarray(times_s) * 1e9).astype(np.int64)
    keep = np.concatenate([np.diff(times_ns) > 0, [True]]) if len(times_ns) else np.zeros(0, dtype=bool)
    return times_ns[keep], np.asarray(values, dtype=np.float64)[keep]


def _held(grid_ns: NDArray[np.int64], times_ns: NDArray[np.int64], values: Array) -> Array:
    latest = np.searchsorted(times_ns, grid_ns, side="right") - 1
    return np.array(np.concatenate([values, [np.nan]])[latest])  # -1, before the first sample, meets the NaN
