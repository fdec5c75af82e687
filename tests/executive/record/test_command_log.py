"""Every command is in the record, as it was given, before the device acts on it."""

from __future__ import annotations

from executive.config.backends import BackendRequest
from executive.core.devices import CABIN, CAMERAS, DRIVE, HEAD, LINK
from executive.core.rig import RigCalibration
from executive.core.types import (
    Call,
    Point,
    Reason,
    Segment,
    Shot,
    Window,
)
from executive.record.command_log import logged
from executive.record.events import Command
from executive.testing import FakeBackend, FakeWorld


def test_each_command_is_written_with_its_values_and_passed_on() -> None:
    route = (Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03),)
    backend = FakeBackend(BackendRequest(FakeWorld(), route, 1, "geometric", RigCalibration(), None, 1.0))
    written: list[Command] = []
    devices = logged(backend.devices, written.append)
    devices[DRIVE].drive(0.1, 0.2, 0.0014)
    devices[CABIN].move(0.1, -0.2)
    devices[HEAD].point(0.3, 0.4)
    devices[CAMERAS].take(Shot((0, 1), (Window(1, 2, 30, 40), Window(5, 6, 70, 80)), 0.5))
    devices[LINK].call(Call(0.0, Reason.TILT, "leaning"))
    assert [(c.device, c.verb) for c in written] == [
        ("tracks", "drive"),
        ("cabin", "move"),
        ("head", "point"),
        ("cameras", "take"),
        ("link", "call"),
    ]
    assert written[0].values == {"left_m": 0.1, "right_m": 0.2, "speed_m_s": 0.0014}
    assert written[2].values == {"pan_rad": 0.3, "tilt_rad": 0.4}
    assert written[3].values["right_width"] == 70.0
    assert backend.robot.moving
    assert len(backend.robot.under_way) == 5


def test_a_stop_is_written_once_after_a_drive() -> None:
    route = (Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03),)
    backend = FakeBackend(BackendRequest(FakeWorld(), route, 1, "geometric", RigCalibration(), None, 1.0))
    written: list[Command] = []
    tracks = logged(backend.devices, written.append)[DRIVE]
    tracks.stop()
    tracks.drive(0.1, 0.1, 0.0014)
    tracks.stop()
    tracks.stop()
    assert [c.verb for c in written] == ["drive", "stop"]
    assert not backend.robot.moving
