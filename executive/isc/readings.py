"""What was read of the devices in one tick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from executive.core.devices import DRIVE, INCLINOMETER, TETHER
from executive.core.ports import Devices
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
    """One tick's readings of everything that is read continuously; None for what this robot does not have."""

    time_s: float
    tracks: TrackReading
    tilt: TiltReading | None
    tether: TetherReading | None
    readings: Readings


def sense(devices: Devices, time_s: float) -> Sensed:
    """Read once every device that is read continuously; each is found under all names it answers to."""
    by_device: dict[str, object] = {}
    for fitted in devices:
        if fitted.spec.sensed and fitted.spec.quantities:
            by_device |= dict.fromkeys(fitted.spec.names, fitted.spec.read(fitted.device))
    readings = Readings(by_device)
    tracks = readings.get(DRIVE.name, TrackReading)
    if tracks is None:
        raise TypeError(f"the drive reads {by_device.get(DRIVE.name)!r}, expected a TrackReading")
    tilt = readings.get(INCLINOMETER.name, TiltReading)
    return Sensed(time_s, tracks, tilt, readings.get(TETHER.name, TetherReading), readings)
