"""The battery's charge."""

from __future__ import annotations

import pytest

from yard_robot.battery import Battery
from yard_robot.config import BatteryConfig

CONFIG = BatteryConfig(capacity=10.0, charge="50 %", idle="20 W", solar="200 W")


def test_an_hour_of_draw_takes_its_watt_hours():
    battery = Battery(BatteryConfig(capacity=100.0, charge="80 %", idle="20 W", solar="0 W"))
    battery.pass_time(3600.0, drawn_w=10.0, light=1.0)
    assert battery.charge == pytest.approx(0.5)


def test_sun_charges_by_what_the_robot_leaves():
    battery = Battery(CONFIG)
    battery.pass_time(36.0, drawn_w=80.0, light=1.0)
    assert battery.read(36.0).power_w == pytest.approx(100.0)
    assert battery.charge == pytest.approx(0.6)


@pytest.mark.parametrize(("drawn_w", "end"), [(1e5, 0.0), (-1e5, 1.0)])
def test_charge_stays_between_empty_and_full(drawn_w, end):
    battery = Battery(CONFIG)
    battery.pass_time(3600.0, drawn_w, light=1.0)
    assert battery.charge == end


def test_leak_drains_and_is_counted():
    battery = Battery(CONFIG)
    battery.leak_w = 3600.0
    battery.pass_time(1.0, drawn_w=180.0, light=1.0)
    assert battery.leaked == pytest.approx(0.1)
    assert battery.charge == pytest.approx(0.4)
