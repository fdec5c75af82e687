"""The devices of this robot: wheels that serve as a drive, a battery, a camera on a pole."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Protocol

from executive.core.devices import DRIVE
from executive.core.ports import Drive
from executive.core.types import Window
from longarm import NUMBER, DeviceSpec, Quantity, ValueType, Verb

from yard_robot.battery import BatteryReading
from yard_robot.eye import Eye

POWER = ValueType("power", float, "W")


class Gauge(Protocol):
    """What tells a battery's state."""

    def read(self) -> BatteryReading:
        """The present state."""
        ...


def _window(window: Window) -> Mapping[str, float]:
    return {name: float(getattr(window, name)) for name in ("u", "v", "width", "height")}


WHEELS: DeviceSpec[Drive] = replace(DRIVE, name="wheels", doc="Two wheels on each side.", serves=DRIVE)

BATTERY: DeviceSpec[Gauge] = DeviceSpec(
    name="battery",
    doc="The battery and the solar panel that charges it.",
    port=Gauge,
    quantities=(
        Quantity("charge", NUMBER, "state of charge, 0 to 1", lambda reading: reading.charge),
        Quantity("power", POWER, "that flows into it, negative when it empties", lambda r: r.power_w),
    ),
)

POLE_CAMERA: DeviceSpec[Eye] = DeviceSpec(
    name="pole_camera",
    doc="The fixed camera on its pole at the edge of the yard.",
    port=Eye,
    verbs=(Verb("expose", _window),),
)
