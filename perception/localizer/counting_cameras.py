"""What a localisation costs: the frames it takes and the time that passes."""

from __future__ import annotations

from executive.core.clock import Clock
from executive.core.ports import Action, Cameras
from executive.core.types import Centres, Images, Shot


class CountingCameras:
    """Cameras that count the frames ordered since `begin`."""

    def __init__(self, cameras: Cameras, clock: Clock) -> None:
        self._cameras, self._clock = cameras, clock
        self.begin()

    def begin(self) -> None:
        """Count anew from here."""
        self.frames, self._began_s = 0, self._clock.now_s

    @property
    def took_s(self) -> float:
        """Mission time since `begin` [s]."""
        return self._clock.now_s - self._began_s

    def take(self, shot: Shot) -> Action[Images | Centres]:
        """Order the shot; see executive.core.ports.Cameras."""
        self.frames += len(shot.leds)
        return self._cameras.take(shot)

    @property
    def cost(self) -> str:
        """What was spent since `begin`, in words."""
        return f"{self.frames} frames, {self.took_s:.0f} s in all"
