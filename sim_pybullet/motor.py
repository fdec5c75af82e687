"""The state of a track motor: what it makes of its command."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Motor:
    """A sound one by default. Its encoder sits on its shaft and sees all of this.

    It turns `speed_factor` times as fast as commanded, backwards if `reversed`, not at all while it has no
    power or is `jammed`; jammed under power it draws its stall current. `astray_m` adds up how far it has
    turned otherwise than it was commanded to.
    """

    speed_factor: float = 1.0
    powered: bool = True
    jammed: bool = False
    reversed: bool = False
    runs_on_s: float = 0.0
    """How long it keeps turning after its drive has ended, as with a relay that sticks."""
    astray_m: float = 0.0

    def turn(self, commanded_m: float, remaining_m: float) -> float:
        """How far the shaft turns in a tick that should bring `commanded_m` of the `remaining_m` to go."""
        turned_m = self._turned(commanded_m, remaining_m)
        self.astray_m += abs(turned_m - to_go(remaining_m, commanded_m))
        return turned_m

    def _turned(self, commanded_m: float, remaining_m: float) -> float:
        if self.jammed or not self.powered:
            return 0.0
        step_m = commanded_m * self.speed_factor
        return -step_m if self.reversed else to_go(remaining_m, step_m)


def to_go(remaining_m: float, step_m: float) -> float:
    """A step towards the end of a travel, not beyond it."""
    return remaining_m if abs(step_m) >= abs(remaining_m) - 1e-12 else step_m
