"""Where a fix may be: no farther from the last one than the belts carried the rover.

A fix beyond that is wrong, however sure of itself it is and however often it repeats: the head has shifted, a
reflection was taken for the rover, a record was replayed. What the motion model expects plays no part here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from executive.core.types import PoseEstimate
from executive.isc.attitude import wrap_rad

SPARE_M, SPARE_RAD = 0.03, math.radians(8.0)  # a stone that gives way, a slope that lets go
OVER = 1.15  # belts stretch and encoders miscount, but not by more
RAD_PER_M = 0.6  # rough ground turns a rover that drives straight
SIGMAS = 4.0


@dataclass(frozen=True)
class Reach:
    """The last fix, and the belt travel [m] and track rotation [rad] since, both without sign."""

    fix: PoseEstimate
    travel_m: float = 0.0
    rotation_rad: float = 0.0

    def driven(self, left_m: float, right_m: float, gauge_m: float) -> Reach:
        """After one tick's belt travels."""
        return replace(
            self,
            travel_m=self.travel_m + (abs(left_m) + abs(right_m)) / 2,
            rotation_rad=self.rotation_rad + abs(right_m - left_m) / gauge_m,
        )

    def beyond(self, fix: PoseEstimate) -> str | None:
        """Why the rover cannot be there, None if it can."""
        moved_m = math.dist(self.fix.position_site_m[:2], fix.position_site_m[:2])
        sigma_m = math.hypot(self.fix.sigma_position_m, fix.sigma_position_m)
        if moved_m > SPARE_M + OVER * self.travel_m + SIGMAS * sigma_m:
            return f"moved {moved_m * 1e3:.0f} mm on {self.travel_m * 1e3:.0f} mm of belt travel"
        turned_rad = abs(wrap_rad(fix.heading_rad - self.fix.heading_rad))
        sigma_rad = math.hypot(self.fix.sigma_heading_rad, fix.sigma_heading_rad)
        could_rad = SPARE_RAD + OVER * self.rotation_rad + RAD_PER_M * self.travel_m + SIGMAS * sigma_rad
        if turned_rad > could_rad:
            turned, could = math.degrees(turned_rad), math.degrees(could_rad)
            return f"turned {turned:.0f} deg where the belts allow {could:.0f} deg"
        return None
