"""Let mission time pass."""

from __future__ import annotations

from executive.core.types import Outcome, Reason
from executive.core.values import DURATION
from executive.tree.nodes.base import In, Leaf


class Wait(Leaf):
    """Let mission time pass."""

    duration = In(DURATION, "how long to wait")

    outcomes = (Reason.DONE, Reason.DEVICE)

    def begin(self) -> None:
        self.until_ticks = self.services.clock.ticks + self.services.clock.ticks_for(self.duration)

    def suspend(self) -> None:
        """Time passes while one looks, too."""

    def resume(self) -> None:
        """The wait ends when it would have."""

    def step(self) -> Outcome[object] | None:
        if self.services.clock.ticks < self.until_ticks:
            return None
        return Outcome(Reason.DONE)
