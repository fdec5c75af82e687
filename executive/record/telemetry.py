"""What a robot's devices report, as events of the record."""

from __future__ import annotations

from collections.abc import Iterator

from executive.core.devices import CABIN, DRIVE, HEAD, INCLINOMETER, TETHER
from executive.core.ports import Devices
from executive.isc import Sensed
from executive.record import events

WHOLE = frozenset(name for spec in (DRIVE, CABIN, HEAD, INCLINOMETER, TETHER) for name in spec.names)
"""The devices of `events.Telemetry`; a robot that has all of them reports them together."""


def samples(now: Sensed, devices: Devices) -> Iterator[events.Telemetry | events.DeviceReading]:
    """One sample of each device that reports anything: what `now` has not, is read."""
    whole = _whole(now, devices)
    if whole is not None:
        yield whole
    for spec, device in ((one.spec, one.device) for one in devices):
        if spec.quantities and not (whole and WHOLE.intersection(spec.names)):
            yield events.DeviceReading(spec.name, spec.sample(device))


def _whole(now: Sensed, devices: Devices) -> events.Telemetry | None:
    """All of a rover with a head, a cabin and a tether; None for any other robot."""
    cabin, head, tilt, tether = devices.get(CABIN), devices.get(HEAD), now.tilt, now.tether
    if cabin is None or head is None or tilt is None or tether is None:
        return None
    joints, pointing = cabin.read(), head.read()
    return events.Telemetry(
        left_m=now.tracks.left_m,
        right_m=now.tracks.right_m,
        left_current_a=now.tracks.left_current_a,
        right_current_a=now.tracks.right_current_a,
        roll_rad=tilt.roll_rad,
        pitch_rad=tilt.pitch_rad,
        arm_rad=joints.arm_rad,
        cabin_rad=joints.cabin_rad,
        pan_rad=pointing.pan_rad,
        tilt_rad=pointing.tilt_rad,
        tether_m=tether.length_m,
        tether_n=tether.tension_n,
        moving=now.tracks.moving,
    )
