"""The fake robot keeps what every backend must keep, and the checker notices when one does not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from executive.config.backends import BackendRequest
from executive.core.rig import RigCalibration
from executive.core.types import Point, Segment
from executive.testing import BACKEND, FakeBackend, FakeWorld, check_backend, fake_with
from executive.testing.check_backend import BackendBreach

ROUTE = (Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03),)
REQUEST = BackendRequest(FakeWorld(), ROUTE, 3, "geometric", RigCalibration(), None, 1.0)


def test_fake_backend_keeps_every_promise() -> None:
    check_backend(BACKEND, REQUEST)


class Jumpy(FakeBackend):
    def advance(self) -> None:
        super().advance()
        self.clock.advance()


class Restless(FakeBackend):
    def safe_stop(self) -> None:
        return None


class Forgetful(FakeBackend):
    seeds = iter(range(100))

    def __init__(self, request: BackendRequest) -> None:
        super().__init__(request)
        self.robot.left_m = float(next(self.seeds))


@pytest.mark.parametrize(
    ("broken", "promise"),
    [(Jumpy, "exactly one tick"), (Restless, "to rest"), (Forgetful, "bit for bit")],
)
def test_checker_names_the_broken_promise(broken: type[FakeBackend], promise: str) -> None:
    with pytest.raises(BackendBreach, match=promise):
        check_backend(replace(BACKEND, create=broken), REQUEST)


def test_checker_refuses_a_tier_that_is_not_offered() -> None:
    with pytest.raises(BackendBreach, match="offers"):
        check_backend(BACKEND, replace(REQUEST, tier="full"))


def test_a_robot_with_some_of_its_devices_keeps_every_promise() -> None:
    check_backend(fake_with("tracks", "cameras", "link"), REQUEST)


def test_a_device_declared_but_not_there_is_noticed() -> None:
    boastful = replace(BACKEND, create=lambda request: FakeBackend(request, ("tracks",)))
    with pytest.raises(BackendBreach, match="its devices are those that its spec names"):
        check_backend(boastful, REQUEST)


def test_a_robot_without_a_drive_is_noticed() -> None:
    with pytest.raises(BackendBreach, match="serves as a drive"):
        check_backend(fake_with("cameras"), REQUEST)
