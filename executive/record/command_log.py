"""Writes every command to a device into the record, on its way there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from executive.core.ports import (
    Action,
    Cabin,
    Cameras,
    Devices,
    Head,
    Link,
    Tracks,
)
from executive.core.types import (
    CabinReading,
    Call,
    Centres,
    HeadReading,
    Images,
    Shot,
    TrackReading,
)
from executive.record.events import Command

Write = Callable[[Command], None]


def logged(devices: Devices, write: Write) -> Devices:
    """The same devices, their commands written before they are carried out. Readings are not commands."""
    return replace(
        devices,
        tracks=LoggedTracks(devices.tracks, write),
        cabin=LoggedCabin(devices.cabin, write),
        head=LoggedHead(devices.head, write),
        cameras=LoggedCameras(devices.cameras, write),
        link=LoggedLink(devices.link, write),
    )


@dataclass
class LoggedTracks:
    inner: Tracks
    write: Write
    _driven: bool = False

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        values = {"left_m": left_m, "right_m": right_m, "speed_m_s": speed_m_s}
        self.write(Command("tracks", "drive", values))
        self._driven = True
        return self.inner.drive(left_m, right_m, speed_m_s)

    def stop(self) -> None:
        self.inner.stop()  # first of all, whatever becomes of the record
        if self._driven:  # a stop that repeats a stop says nothing
            self._driven = False
            self.write(Command("tracks", "stop"))

    def read(self) -> TrackReading:
        return self.inner.read()


@dataclass
class LoggedCabin:
    inner: Cabin
    write: Write

    def move(self, arm_rad: float, cabin_rad: float) -> Action[CabinReading]:
        self.write(Command("cabin", "move", {"arm_rad": arm_rad, "cabin_rad": cabin_rad}))
        return self.inner.move(arm_rad, cabin_rad)

    def read(self) -> CabinReading:
        return self.inner.read()


@dataclass
class LoggedHead:
    inner: Head
    write: Write

    def point(self, pan_rad: float, tilt_rad: float) -> Action[HeadReading]:
        self.write(Command("head", "point", {"pan_rad": pan_rad, "tilt_rad": tilt_rad}))
        return self.inner.point(pan_rad, tilt_rad)

    def read(self) -> HeadReading:
        return self.inner.read()


@dataclass
class LoggedCameras:
    inner: Cameras
    write: Write

    def take(self, shot: Shot) -> Action[Images | Centres]:
        values = {"frames": float(len(shot.leds)), "cadence_s": shot.cadence_s}
        for side, window in zip(("left", "right"), shot.windows or (), strict=False):
            values |= {f"{side}_u": float(window.u), f"{side}_v": float(window.v)}
            values |= {f"{side}_width": float(window.width), f"{side}_height": float(window.height)}
        self.write(Command("cameras", "take", values))
        return self.inner.take(shot)


@dataclass
class LoggedLink:
    inner: Link
    write: Write

    def call(self, call: Call) -> Action[str]:
        self.write(Command("link", "call"))
        return self.inner.call(call)
