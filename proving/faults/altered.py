"""What faults share: evidence counted, and actions whose outcome is altered or held back on its way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from executive.core.clock import Clock
from executive.core.ports import Action
from executive.core.types import Outcome, Reason
from executive.run import Fault

T = TypeVar("T")


class Counted(Fault):
    """A fault whose evidence is how often it altered an answer, a command or a tick."""

    altered = 0

    def took_effect(self) -> bool:
        return self.altered > 0


@dataclass
class Altered(Generic[T]):
    """An action whose outcome is altered once, when it comes, and then stays."""

    inner: Action[T]
    alter: Callable[[Outcome[T]], Outcome[T]]
    outcome: Outcome[T] | None = None

    def poll(self) -> Outcome[T] | None:
        answer = self.inner.poll() if self.outcome is None else None
        if answer is not None:
            self.outcome = self.alter(answer)
        return self.outcome

    def cancel(self) -> None:
        self.inner.cancel()


@dataclass
class Held(Generic[T]):
    """An action whose outcome is held back for `by_s`; counts to `fault` once it is. Cancelled at once."""

    inner: Action[T]
    clock: Clock
    by_s: float
    fault: Counted
    outcome: Outcome[T] | None = None
    _until_tick: int | None = None

    def poll(self) -> Outcome[T] | None:
        answer = self.inner.poll() if self.outcome is None else None
        if answer is not None:
            if self._until_tick is None:
                self._until_tick = self.clock.ticks + self._ticks(answer)
            if self.clock.ticks >= self._until_tick:
                self.outcome = answer
        return self.outcome

    def cancel(self) -> None:
        self.inner.cancel()
        if self._until_tick is not None:
            self.outcome = self.outcome or Outcome(Reason.CANCELLED)

    def _ticks(self, answer: Outcome[T]) -> int:
        if answer.reason is Reason.CANCELLED:
            return 0
        self.fault.altered += 1
        return self.clock.ticks_for(self.by_s)


@dataclass
class Unanswered(Generic[T]):
    """An action that nobody carries out: it ends with `end` after `after_s`."""

    clock: Clock
    after_s: float
    end: Outcome[T]
    outcome: Outcome[T] | None = None

    def __post_init__(self) -> None:
        self._until_tick = self.clock.ticks + self.clock.ticks_for(self.after_s)

    def poll(self) -> Outcome[T] | None:
        if self.outcome is None and self.clock.ticks >= self._until_tick:
            self.outcome = self.end
        return self.outcome

    def cancel(self) -> None:
        self.outcome = self.outcome or Outcome(Reason.CANCELLED)
