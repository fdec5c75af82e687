"""Actions written as generators: what has to be waited for yields, and cancelling closes the generator."""

from __future__ import annotations

from collections.abc import Generator
from typing import Generic, TypeVar

from executive.core.clock import Clock
from executive.core.ports import Action
from executive.core.types import Outcome, Reason

T = TypeVar("T")
Steps = Generator[None, None, T]


class Routine(Generic[T]):
    """An `Action` that runs a generator one yield a poll; its return value is the outcome."""

    def __init__(self, steps: Steps[Outcome[T]]) -> None:
        self._steps = steps
        self._outcome: Outcome[T] | None = None

    def poll(self) -> Outcome[T] | None:
        if self._outcome is None:
            try:
                next(self._steps)
            except StopIteration as end:
                self._outcome = end.value
        return self._outcome

    def cancel(self) -> None:
        if self._outcome is None:
            self._steps.close()  # runs the `finally` of `wait_for`, which cancels the device
            self._outcome = Outcome(Reason.CANCELLED)


def wait_for(action: Action[T], clock: Clock, deadline_s: float) -> Steps[Outcome[T]]:
    """Poll an action once a tick until it ends; TIMEOUT past the deadline. It never outlives the wait."""
    try:
        while (outcome := action.poll()) is None:
            if clock.now_s > deadline_s:
                return Outcome(Reason.TIMEOUT, f"no answer by {deadline_s:.0f} s")
            yield
        return outcome
    finally:
        action.cancel()
