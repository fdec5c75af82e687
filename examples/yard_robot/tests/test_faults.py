"""Faults act on the world, show evidence of it, and are taken back."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from yard_robot import faults
from yard_robot.backend import YardBackend
from yard_robot.marker_box import FACES


@pytest.fixture
def backend(world) -> YardBackend:
    """The world behind a backend that needs no request."""
    made = object.__new__(YardBackend)
    made.world = world
    return made


def made(spec, **parameters):
    return spec.make(spec.model(**parameters))


def tick(backend) -> None:
    backend.world.advance()
    backend.world.eye.settle()


def test_wheel_slip_shows_only_once_it_has_lost_way(backend):
    fault = made(faults.SLIPPING, slip="50 %", side="left")
    fault.apply(backend, 1.0)
    tick(backend)
    fault.watch(backend)
    assert not fault.took_effect()
    backend.world.wheels.drive(1.0, 1.0, 0.3)
    for _ in range(4):
        tick(backend)
    fault.watch(backend)
    assert fault.took_effect()
    assert backend.world.slip == (0.5, 0.0)


def test_battery_drain_empties_the_battery_until_it_is_over(backend):
    fault = made(faults.BATTERY_DRAIN, power="10 kW")
    before = backend.world.battery.charge
    fault.apply(backend, 1.0)
    tick(backend)
    fault.watch(backend)
    assert fault.took_effect()
    assert backend.world.battery.charge < before - 0.05
    fault.apply(backend, 0.0)
    drained = backend.world.battery.charge
    tick(backend)
    assert backend.world.battery.charge > drained


def test_cover_hides_the_faces_that_the_camera_sees(backend):
    fault = made(faults.COVERED)
    fault.apply(backend, 1.0)
    assert backend.world.model.covered == {"top", "back"}  # the robot looks straight away from the camera
    fault.apply(backend, 0.0)
    assert backend.world.model.covered == frozenset()


def test_cover_of_all_faces_hides_all(backend):
    made(faults.COVERED, faces="all").apply(backend, 1.0)
    assert backend.world.model.covered == set(FACES)


def test_dark_camera_is_evident_after_a_picture(backend):
    fault = made(faults.CAMERA_DARK, left="5 %")
    fault.apply(backend, 1.0)
    fault.watch(backend)
    assert not fault.took_effect()
    backend.world.eye.expose(SimpleNamespace(u=0, v=0, width=64, height=64))
    for _ in range(3):
        tick(backend)
    fault.watch(backend)
    assert fault.took_effect()
    assert backend.world.iris == pytest.approx(0.05)


def test_fault_of_the_yard_refuses_another_robot():
    with pytest.raises(Exception, match="expected the yard"):
        made(faults.CAMERA_DARK).apply(SimpleNamespace(), 1.0)
