"""Whether a drive goes as its encoders should tell: a belt that counts nothing may run away unseen."""

from __future__ import annotations

from collections.abc import Iterator

from executive.core.types import TrackReading
from executive.navigation.guidance import Belts

WINDOW_M = 0.010  # looked at each time that so much is due: a belt may need a moment to get under way
LEAST_SHARE = 0.25  # of what is due; a weak motor makes more
DONE_M = 0.001  # a belt with no more than this to go may wait for the other
LONGEST, SLACK_S = 2.0, 10.0  # a drive that takes longer than twice its time and this will not end


class BeltWatch:
    """Looks on at a drive under way: what was commanded, against what is counted. Ask it once a tick."""

    def __init__(self, belts: Belts, speed_m_s: float, started: TrackReading) -> None:
        """`speed_m_s` is the faster belt's."""
        self._belts_m = (belts.left_m, belts.right_m)
        self._planned_s = max(abs(m) for m in self._belts_m) / speed_m_s
        self._started_s, self._started_m = started.time_s, (started.left_m, started.right_m)
        self._looked = [(0.0, 0.0), (0.0, 0.0)]  # time since the start, and what was counted until then

    @property
    def longest_s(self) -> float:
        """The longest this drive may take [s]."""
        return LONGEST * self._planned_s + SLACK_S

    def undone(self, now: TrackReading) -> float:
        """The share of the way, by the belt that has more of it, that is not counted yet: 0 to 1."""
        counted_m = (now.left_m - self._started_m[0], now.right_m - self._started_m[1])
        far_m, done_m = max(zip(self._belts_m, counted_m, strict=True), key=lambda pair: abs(pair[0]))
        return min(max(1.0 - done_m / far_m, 0.0), 1.0) if far_m else 0.0

    def problem(self, now: TrackReading) -> str | None:
        """What is wrong with this drive, None if nothing is."""
        elapsed_s = now.time_s - self._started_s
        if elapsed_s > self.longest_s:
            return f"still driving after {elapsed_s:.0f} s, {self._planned_s:.0f} s were planned"
        return next(self._stalled(elapsed_s, (now.left_m, now.right_m)), None)

    def _stalled(self, elapsed_s: float, reading_m: tuple[float, float]) -> Iterator[str]:
        for side, name in enumerate(("left", "right")):
            commanded_m, counted_m = self._belts_m[side], reading_m[side] - self._started_m[side]
            since_s, then_m = self._looked[side]
            due_m = commanded_m * (elapsed_s - since_s) / self._planned_s if self._planned_s else 0.0
            if abs(due_m) < WINDOW_M or abs(commanded_m - counted_m) <= DONE_M:
                continue
            if (counted_m - then_m) / due_m < LEAST_SHARE:
                yield f"the {name} belt counted {(counted_m - then_m) * 1e3:.0f} of {due_m * 1e3:.0f} mm"
            self._looked[side] = elapsed_s, counted_m
