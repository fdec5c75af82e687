"""Stand-ins until the core's devices are open: a cabin, a head and a tether that this robot does not have.

Goes away with `Devices` as a mapping, rigs of the backend's own and `LocalizerSpec`.
"""

from __future__ import annotations

from typing import Any, NoReturn

from executive.core.clock import Clock
from executive.core.ports import Devices
from executive.core.rig import RigCalibration, RoverCalibration
from executive.core.types import CabinReading, HeadReading, TetherReading

from yard_robot.link import YardLink
from yard_robot.localizer import MarkerLocalizer
from yard_robot.rig import YardRig
from yard_robot.world import World


class Nothing:
    """A cabin, a head and a tether at once, none of which is there."""

    def __init__(self, clock: Clock, kind: type[Any]) -> None:
        self._clock, self._kind = clock, kind

    def move(self, arm_rad: float, cabin_rad: float) -> NoReturn:
        raise LookupError("there is no cabin")

    def point(self, pan_rad: float, tilt_rad: float) -> NoReturn:
        raise LookupError("there is no head")

    def read(self) -> Any:
        rest = (False,) if self._kind is not TetherReading else ()
        return self._kind(self._clock.now_s, 0.0, 0.5 if self._kind is TetherReading else 0.0, *rest)


def devices(world: World, link: YardLink) -> Devices:
    """The yard robot's devices in the core's fixed form."""
    return Devices(
        tracks=world.wheels,
        cabin=Nothing(world.clock, CabinReading),
        head=Nothing(world.clock, HeadReading),
        cameras=world.eye,  # type: ignore[arg-type]
        inclinometer=world.inclinometer,
        tether=Nothing(world.clock, TetherReading),
        link=link,
    )


def rig_of(rig: YardRig) -> RigCalibration:
    """The core's rig with what it needs of a robot."""
    husky = rig.husky
    return RigCalibration(
        rover=RoverCalibration(
            length_m=husky.length_m,
            width_m=husky.width_m,
            height_m=husky.height_m,
            track_gauge_m=husky.gauge_m,
            speed_m_s=husky.speed_m_s,
        )
    )


def localizer(devices: Devices, rig: RigCalibration, clock: Clock) -> MarkerLocalizer:
    """The localizer as today's core makes it."""
    eye: Any = devices.cameras
    return MarkerLocalizer(eye.inner, YardRig())
