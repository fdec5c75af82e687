"""What was read of the devices in one tick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from executive.core.types import TetherReading, TiltReading, TrackReading

R = TypeVar("R")


@dataclass(frozen=True)
class Readings:
    """The latest readings by the names of their devices."""

    by_device: Mapping[str, object] = field(default_factory=dict)

    def get(self, device: str, kind: type[R]) -> R | None:
        """The reading of a device; None where there is no such device, or it reads something else."""
        reading = self.by_device.get(device)
        return reading if isinstance(reading, kind) else None


@dataclass(frozen=True)
class Sensed:
    """One tick's readings of everything that is read continuously."""

    time_s: float
    tracks: TrackReading
    tilt: TiltReading
    tether: TetherReading

    @property
    def readings(self) -> Readings:
        return Readings({"tracks": self.tracks, "inclinometer": self.tilt, "tether": self.tether})
