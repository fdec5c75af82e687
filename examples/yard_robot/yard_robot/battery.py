"""The battery: charge against what the motors draw and what the solar panel yields."""

from __future__ import annotations

from dataclasses import dataclass

from yard_robot.config import BatteryConfig

_J_PER_WH = 3600.0


@dataclass(frozen=True)
class BatteryReading:
    """State of charge (0 … 1), and the power that flows into the battery [W], negative when it empties."""

    time_s: float
    charge: float
    power_w: float


class Battery:
    """Charge over mission time. `leak_w` is what drains it besides the robot's own consumers."""

    def __init__(self, config: BatteryConfig) -> None:
        self._config = config
        self._charge_j = config.charge * config.capacity * _J_PER_WH
        self._power_w = 0.0
        self.leak_w = 0.0
        self.leaked = 0.0
        """What the leak has drained so far, as a share of the capacity."""

    @property
    def charge(self) -> float:
        """State of charge, 0 … 1."""
        return self._charge_j / (self._config.capacity * _J_PER_WH)

    def pass_time(self, seconds: float, drawn_w: float, light: float) -> None:
        """Let time pass with this drawn by the motors and this light (1 by a clear day)."""
        self._power_w = self._config.solar * light - self._config.idle - drawn_w - self.leak_w
        self.leaked += self.leak_w * seconds / (self._config.capacity * _J_PER_WH)
        full_j = self._config.capacity * _J_PER_WH
        self._charge_j = min(max(self._charge_j + self._power_w * seconds, 0.0), full_j)

    def read(self, time_s: float) -> BatteryReading:
        """What the battery's gauge shows."""
        return BatteryReading(time_s, self.charge, self._power_w)
