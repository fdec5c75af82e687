"""Signals by name: of devices, of the record's own events, of plug-ins."""

import pytest

from executive.config.backends import BackendRequest
from executive.core.rig import RigCalibration
from executive.core.types import Point, Segment
from executive.isc.readings import sense
from executive.record.events import DeviceReading, Telemetry
from executive.record.signals import listener
from executive.record.telemetry import samples
from executive.record.topics import RECORD, topic_named
from executive.testing import FakeBackend, FakeWorld

ROUTE = (Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03),)


def sampled(*devices):
    request = BackendRequest(FakeWorld(), ROUTE, 1, "geometric", RigCalibration(), None, 1.0)
    backend = FakeBackend(request, devices) if devices else FakeBackend(request)
    return list(samples(sense(backend.devices, 0.0), backend.devices))


def test_a_whole_rover_reports_in_one_sample():
    assert [type(event) for event in sampled()] == [Telemetry]


def test_another_robot_reports_device_by_device():
    events = sampled("tracks", "inclinometer", "cameras")
    assert [event.device for event in events] == ["tracks", "inclinometer"]
    assert events[0].values["left_current"] == pytest.approx(0.02)


def test_both_forms_of_a_sample_give_the_same_signals():
    heard = listener()
    whole = dict(heard(sampled()[0]))
    apart = dict(signal for event in sampled("tracks", "inclinometer") for signal in heard(event))
    assert set(apart) == {"left", "right", "left_current", "right_current", "moving", "roll", "pitch", "tilt"}
    assert apart == {name: whole[name] for name in apart}


def test_a_reading_of_a_device_has_a_topic_of_its_own():
    event = DeviceReading("battery", {"charge": 0.75})
    topic = next(topic for topic in RECORD if topic.event is DeviceReading)
    assert topic.name + topic.suffix(event) == "/device/battery"
    assert topic_named("/device/battery") is topic
    assert topic.decode(topic.encode(event, 0)) == event
