"""The other place where the rover may be: where its belts took it since the last fix that could be trusted.

A fix that the motion model does not explain may be right, and the rover stuck; or false, and the rover where
the belts say. Until a later drive settles it both places count: no drive may go where either is out of the
corridor, and all that is driven meanwhile, by whatever remedy, counts against one bound.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from executive.core import corridor
from executive.core.types import PoseEstimate, Segment
from executive.isc import prediction
from executive.isc.correction import innovate
from executive.isc.motion import MotionNoise, MotionState

MOST_WIDTHS = 2.0
"""Of the off-track margin: the way in doubt that remedies may drive in all. It is the corridor's width: from
anywhere inside, a line of that length leads out."""

AGREES = 16.3
"""Squared innovation in x, y and heading below which a fix confirms the belts: 99.9 % of chi2(3)."""

LEAST_WAY_M = 0.02  # a fix after less says nothing of whether the last was right


@dataclass(frozen=True)
class Doubt:
    """The place by the belts, and the way of the body [m] since the last trusted fix, without sign."""

    belts: MotionState
    way_m: float = 0.0
    since_fix_m: float = 0.0
    """Of that, since the last fix, trusted or not."""
    open: bool = False
    """Whether a fix since contradicts the belts."""

    def driven(
        self, left_m: float, right_m: float, gauge_m: float, time_s: float, noise: MotionNoise
    ) -> Doubt:
        """After one tick's belt travels."""
        way_m = abs(left_m + right_m) / 2
        belts = prediction.predict(self.belts, left_m, right_m, gauge_m, time_s, noise)
        return replace(self, belts=belts, way_m=self.way_m + way_m, since_fix_m=self.since_fix_m + way_m)

    def after_fix(self, fix: PoseEstimate, explained: bool, state: MotionState) -> Doubt:
        """After a fix was taken in, the filter now at `state`.

        It is trusted where the belts' place is the fix's, or where the model explains it: while in doubt only
        after a drive, since looking twice at the same wrong thing shows the same.
        """
        settled = explained and (not self.open or self.since_fix_m >= LEAST_WAY_M)
        if settled or self._agrees(fix):
            return Doubt(state)
        return replace(self, since_fix_m=0.0, open=True)

    def refused(self) -> Doubt:
        """After a fix was refused: what the belts did since cannot be confirmed."""
        return replace(self, open=True)

    def room_m(self, segment: Segment, sigmas: float) -> float:
        """How far the place by the belts is from leaving the corridor [m]; inf where there is no doubt."""
        return corridor.room_m(self.belts.pose(), segment, sigmas) if self.open else float("inf")

    def exceeded(self, segment: Segment) -> str | None:
        """Why nothing more may be driven in doubt on this segment, None if it may."""
        most_m = MOST_WIDTHS * segment.off_track_m
        if not self.open or self.way_m <= most_m:
            return None
        way, most = self.way_m * 1e3, most_m * 1e3
        return f"{way:.0f} mm driven since the last fix that can be trusted, at most {most:.0f} mm"

    def _agrees(self, fix: PoseEstimate) -> bool:
        innovation, spread = innovate(self.belts, fix)
        return float(innovation @ np.linalg.solve(spread, innovation)) < AGREES
