"""The devices that the executive ships a port for. Its algorithms need a drive; leaves say what they need.

A robot with other devices declares them in the same way, in a package of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from executive.core.device_spec import DeviceSpec, Quantity, Verb, numbers
from executive.core.ports import Cabin, Cameras, Drive, Head, Inclinometer, Link, Tether
from executive.core.types import Shot, TrackReading
from executive.core.values import ANGLE, CURRENT, FLAG, FORCE, LENGTH, ValueType


def _shot(shot: Shot) -> Mapping[str, float]:
    values = {"frames": float(len(shot.leds)), "cadence_s": shot.cadence_s}
    for side, window in zip(("left", "right"), shot.windows or (), strict=False):
        values |= {f"{side}_u": float(window.u), f"{side}_v": float(window.v)}
        values |= {f"{side}_width": float(window.width), f"{side}_height": float(window.height)}
    return values


def _drive(name: str, kind: ValueType[Any], doc: str, of: Callable[[TrackReading], float]) -> Quantity:
    return Quantity(name, kind, doc, of, signal=name)


DRIVE: DeviceSpec[Drive] = DeviceSpec(
    name="drive",
    doc="Belts or wheels on two sides, driven by travel.",
    port=Drive,
    quantities=(
        _drive("left", LENGTH, "travel of the left belt", lambda r: r.left_m),
        _drive("right", LENGTH, "travel of the right belt", lambda r: r.right_m),
        _drive("left_current", CURRENT, "of the left motor", lambda r: r.left_current_a),
        _drive("right_current", CURRENT, "of the right motor", lambda r: r.right_current_a),
        _drive("moving", FLAG, "whether a drive is under way", lambda r: r.moving),
    ),
    verbs=(Verb("drive", numbers("left_m", "right_m", "speed_m_s")), Verb("stop", stops=True)),
    rest=lambda drive: drive.stop(),
)
TRACKS: DeviceSpec[Drive] = replace(DRIVE, name="tracks", doc="Two tracks.", serves=DRIVE)

INCLINOMETER: DeviceSpec[Inclinometer] = DeviceSpec(
    name="inclinometer",
    doc="The body's tilt against gravity.",
    port=Inclinometer,
    quantities=(
        Quantity("roll", ANGLE, "about the body's x axis", lambda r: r.roll_rad, "roll"),
        Quantity("pitch", ANGLE, "about the body's y axis", lambda r: r.pitch_rad, "pitch"),
    ),
)

CABIN: DeviceSpec[Cabin] = DeviceSpec(
    name="cabin",
    doc="The payload cabin on its arm and cabin joints.",
    port=Cabin,
    quantities=(
        Quantity("arm", ANGLE, "angle of the arm joint", lambda r: r.arm_rad, "arm"),
        Quantity("cabin", ANGLE, "angle of the cabin joint", lambda r: r.cabin_rad, "cabin"),
    ),
    sensed=False,
    verbs=(Verb("move", numbers("arm_rad", "cabin_rad")),),
)

HEAD: DeviceSpec[Head] = DeviceSpec(
    name="head",
    doc="The pan-tilt unit under the cameras.",
    port=Head,
    quantities=(
        Quantity("pan", ANGLE, "of the head, by its encoder", lambda r: r.pan_rad, "pan"),
        Quantity("tilt", ANGLE, "of the head, by its encoder", lambda r: r.tilt_rad),
    ),
    sensed=False,
    verbs=(Verb("point", numbers("pan_rad", "tilt_rad")),),
)

CAMERAS: DeviceSpec[Cameras] = DeviceSpec(
    name="cameras",
    doc="The stereo pair and the LED sequencer, triggered together.",
    port=Cameras,
    verbs=(Verb("take", _shot),),
)

TETHER: DeviceSpec[Tether] = DeviceSpec(
    name="tether",
    doc="The tether and its spool.",
    port=Tether,
    quantities=(
        Quantity("length", LENGTH, "paid out", lambda r: r.length_m),
        Quantity("tension", FORCE, "at the spool", lambda r: r.tension_n),
    ),
)

LINK: DeviceSpec[Link] = DeviceSpec(
    name="link",
    doc="The link to ground.",
    port=Link,
    verbs=(Verb("call"),),
)
