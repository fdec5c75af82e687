"""Whether a drive goes as its encoders should tell: a belt that counts nothing may run away unseen."""

from __future__ import annotations

from dataclasses import dataclass

from executive.guidance import Belts
from executive.types import TrackReading

LEAST_DUE_M = 0.010  # below this a belt may still be getting under way
LEAST_SHARE = 0.25  # of what is due; a weak motor makes more
LONGEST, SLACK_S = 2.0, 10.0  # a drive that takes longer than twice its time and this will not end


@dataclass(frozen=True)
class BeltWatch:
    """A drive under way: what was commanded, at which speed of the faster belt, and what was counted then."""

    belts: Belts
    speed_m_s: float
    started: TrackReading

    def problem(self, now: TrackReading) -> str | None:
        """What is wrong with this drive, None if nothing is."""
        elapsed_s = now.time_s - self.started.time_s
        planned_s = max(abs(self.belts.left_m), abs(self.belts.right_m)) / self.speed_m_s
        if elapsed_s > LONGEST * planned_s + SLACK_S:
            return f"still driving after {elapsed_s:.0f} s, {planned_s:.0f} s were planned"
        share = min(1.0, elapsed_s / planned_s) if planned_s > 0.0 else 0.0
        left = self._stalled("left", share * self.belts.left_m, now.left_m - self.started.left_m)
        return left or self._stalled("right", share * self.belts.right_m, now.right_m - self.started.right_m)

    @staticmethod
    def _stalled(side: str, due_m: float, counted_m: float) -> str | None:
        if abs(due_m) < LEAST_DUE_M or counted_m / due_m >= LEAST_SHARE:
            return None
        return f"the {side} belt counted {counted_m * 1e3:.0f} mm of {due_m * 1e3:.0f} mm"
