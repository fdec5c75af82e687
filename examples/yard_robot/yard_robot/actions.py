"""Actions that a device ends, and readings that hold still within a tick."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from longarm import Outcome, Reason

T = TypeVar("T")


class DeviceAction(Generic[T]):
    """An action that its device ends. `on_cancel` stops the device."""

    def __init__(self, on_cancel: Callable[[], None] = lambda: None) -> None:
        self._on_cancel = on_cancel
        self._outcome: Outcome[T] | None = None

    def poll(self) -> Outcome[T] | None:
        """The outcome, or None while under way."""
        return self._outcome

    def end(self, outcome: Outcome[T]) -> None:
        """Set the outcome; the first one stays."""
        if self._outcome is None:
            self._outcome = outcome

    def cancel(self) -> None:
        """Stop the device now, if this is still under way."""
        if self._outcome is None:
            self.end(Outcome(Reason.CANCELLED))
            self._on_cancel()


class PerTick(Generic[T]):
    """A noisy reading drawn once a tick, however many ask."""

    def __init__(self, draw: Callable[[], T], ticks: Callable[[], int]) -> None:
        self._draw, self._ticks = draw, ticks
        self._last: tuple[int, T] | None = None

    def read(self) -> T:
        """The reading of this tick."""
        if self._last is None or self._last[0] != self._ticks():
            self._last = (self._ticks(), self._draw())
        return self._last[1]
