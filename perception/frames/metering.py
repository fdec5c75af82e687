"""The exposure: as long as the cameras were set to, or shorter, until stray light does not fill the wells."""

from __future__ import annotations

from executive.core.clock import Clock
from executive.core.devices import CAMERAS
from executive.core.ports import Devices
from executive.core.rig import RigCalibration
from executive.core.types import Shot, Window
from perception.frames.routine import Steps, wait_for
from perception.frames.shots import overexposed

_STEP = 0.5
_SHORTEST = 1 / 16
_FILLED = 1.75  # variance over that of sunlit ground, of the wells that stray light fills after the last step


class Metering:
    """Finds the longest of the exposures that single dark frames come back from unsaturated."""

    def __init__(self, devices: Devices, rig: RigCalibration, clock: Clock) -> None:
        self._devices, self._rig, self._clock = devices, rig, clock
        self.exposure = 1.0

    @property
    def pairs_factor(self) -> float:
        """How many times as many pairs as at full exposure, of less light of markers in fuller wells."""
        return 1.0 if self.exposure == 1.0 else _FILLED * self.exposure**-2

    def measure(self, windows: tuple[Window, Window], deadline_s: float) -> Steps[bool]:
        """Set the exposure by the light in the windows; whether they show something at one of those tried."""
        exposure = 1.0
        while exposure >= _SHORTEST:
            shot = Shot((0,), windows, exposure=exposure)
            taken = yield from wait_for(self._devices[CAMERAS].take(shot), self._clock, deadline_s)
            if taken.value is None or not taken.ok:
                return False
            if not overexposed(taken.value, self._rig.sensor):
                self.exposure = exposure
                return True
            exposure *= _STEP
        return False
