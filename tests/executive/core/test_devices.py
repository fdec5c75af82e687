from types import SimpleNamespace

import pytest

from executive.core.device_spec import DEVICE_KIND, DeviceSpec, Quantity, Verb
from executive.core.devices import CAMERAS, DRIVE, HEAD, TETHER, TRACKS
from executive.core.ports import Devices, MissingDevice
from executive.core.types import TetherReading, TrackReading
from executive.core.values import NUMBER

BATTERY = DeviceSpec("battery", "What is left.", object, (Quantity("charge", NUMBER, "left", lambda r: r),))


def test_a_device_is_found_by_what_it_serves_as():
    tracks = SimpleNamespace()
    devices = Devices(TRACKS.fit(tracks))
    assert devices[DRIVE] is tracks
    assert devices[TRACKS] is tracks
    assert devices.named("drive") is devices.named("tracks") is tracks


def test_a_missing_device_is_named_with_those_there():
    devices = Devices(TRACKS.fit(SimpleNamespace()), CAMERAS.fit(SimpleNamespace()))
    assert devices.get(HEAD) is None
    with pytest.raises(MissingDevice, match="no device 'head' on this robot; it has cameras, tracks"):
        devices[HEAD]


def test_replacing_a_device_leaves_the_first_ones_alone():
    before = Devices(TRACKS.fit("old"), CAMERAS.fit("cameras"))
    after = before.replace(DRIVE, "new")
    assert before[TRACKS] == "old"
    assert after[TRACKS] == after[DRIVE] == "new"
    assert [one.spec for one in after] == [TRACKS, CAMERAS]
    with pytest.raises(MissingDevice):
        before.replace(HEAD, "a head")


def test_two_devices_cannot_share_a_name():
    with pytest.raises(ValueError, match="tracks and drive both answer to 'drive'"):
        Devices(TRACKS.fit(1), DRIVE.fit(2))


def test_a_sample_has_every_quantity_as_a_number():
    reading = TrackReading(3.0, 1.0, 2.0, 0.1, 0.2, True)
    sample = TRACKS.sample(SimpleNamespace(read=lambda: reading))
    assert sample == {"left": 1.0, "right": 2.0, "left_current": 0.1, "right_current": 0.2, "moving": 1.0}


def test_a_device_without_quantities_is_not_read():
    assert CAMERAS.sample(SimpleNamespace()) == {}


def test_signals_are_named_after_their_device_by_default():
    assert [BATTERY.signal(q) for q in BATTERY.quantities] == ["battery_charge"]
    assert [TETHER.signal(q) for q in TETHER.quantities] == ["tether_length", "tether_tension"]
    tether = SimpleNamespace(read=lambda: TetherReading(0.0, 5.0, 0.3))
    assert TETHER.sample(tether) == {"length": 5.0, "tension": 0.3}
    assert [TRACKS.signal(q) for q in TRACKS.quantities][:2] == ["left", "right"]


def test_what_a_device_cannot_keep_is_named():
    twice = DeviceSpec("twin", " ", object, BATTERY.quantities * 2, (Verb("charge"),))
    assert DEVICE_KIND.faults_of("twin", twice) == (
        "it does not say what it is",
        "it reports charge twice",
        "its port has no charge",
    )
    assert DEVICE_KIND.faults_of("battery", BATTERY) == ()


def test_the_catalogue_says_what_a_device_reports():
    page = DEVICE_KIND.page(BATTERY)
    assert page["reports"] == [{"signal": "battery_charge", "type": "number", "unit": None, "doc": "left"}]
    assert DEVICE_KIND.page(TRACKS)["serves"] == "drive"
    assert DEVICE_KIND.page(TRACKS)["commands"] == ["drive", "stop"]
