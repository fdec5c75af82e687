"""One motor-driven angle: it goes to its target at a constant rate, in mission time."""

from __future__ import annotations

import math


class Axis:
    """An angle under way to a target."""

    def __init__(self, angle_rad: float, rate_rad_s: float) -> None:
        self.angle_rad = self.target_rad = angle_rad
        self._rate_rad_s = rate_rad_s

    @property
    def arrived(self) -> bool:
        return self.angle_rad == self.target_rad

    def stop(self) -> None:
        """Stay here."""
        self.target_rad = self.angle_rad

    def advance(self, tick_s: float) -> None:
        """Turn for one tick."""
        left_rad, step_rad = self.target_rad - self.angle_rad, self._rate_rad_s * tick_s
        if abs(left_rad) <= step_rad:
            self.angle_rad = self.target_rad
        else:
            self.angle_rad += math.copysign(step_rad, left_rad)


def within(angle_rad: float, limits_rad: tuple[float, float]) -> bool:
    """Whether a finite angle lies within its limits; they themselves belong to them."""
    return limits_rad[0] - 1e-9 <= angle_rad <= limits_rad[1] + 1e-9
