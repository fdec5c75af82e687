"""Belts that move without a command are noticed within a few ticks, and stopped again."""

import math
from dataclasses import replace

from executive.config.backends import BackendRequest
from executive.core.devices import DRIVE
from executive.core.rig import RigCalibration
from executive.core.types import Point, Segment
from executive.navigation.belt_rest import RestingDrive
from executive.testing import FakeBackend, FakeWorld

SPEED_M_S = 0.0014


class Bench:
    """A fake robot's tracks, whose right belt may run on by itself."""

    def __init__(self):
        route = (Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03),)
        self.backend = FakeBackend(
            BackendRequest(FakeWorld(), route, 3, "geometric", RigCalibration(), None, 1.0)
        )
        self.stops = 0
        inner = self.backend.devices[DRIVE]
        stop = inner.stop
        inner.stop = lambda: (stop(), setattr(self, "stops", self.stops + 1))
        self.tracks = RestingDrive(inner)
        self.runaway_m = 0.0

    def told(self, ticks):
        """What is told on each of so many ticks."""
        words = []
        for _ in range(ticks):
            self.backend.advance()
            self.backend.robot.right_m += self.runaway_m
            words.append(self.tracks.astray(self.tracks.read()))
        return words


def test_a_drive_and_the_rest_after_it_say_nothing():
    bench = Bench()
    bench.tracks.drive(0.05, 0.03, SPEED_M_S)
    assert not any(bench.told(120))
    bench.tracks.stop()
    assert not any(bench.told(20))


def test_a_belt_that_runs_on_is_told_within_five_ticks_and_stopped_again():
    bench = Bench()
    bench.tracks.drive(0.01, 0.01, SPEED_M_S)
    bench.told(20)
    bench.stops, bench.runaway_m = 0, SPEED_M_S
    words = bench.told(5)
    assert any("right belt moved by" in word for word in words if word)
    assert bench.stops == 1


def test_a_belt_that_goes_on_is_told_again():
    bench = Bench()
    bench.told(2)
    bench.runaway_m = SPEED_M_S
    assert sum(word is not None for word in bench.told(60)) >= 2
    bench.runaway_m = 0.0
    assert not any(bench.told(60))


def test_a_belt_that_runs_on_after_a_stop_in_mid_drive_is_told():
    bench = Bench()
    bench.tracks.drive(0.1, 0.1, SPEED_M_S)
    bench.told(10)
    bench.tracks.stop()
    bench.runaway_m = SPEED_M_S
    assert any(bench.told(6))


def test_a_counter_that_says_nothing_is_no_runaway():
    bench = Bench()
    bench.told(2)
    assert bench.tracks.astray(replace(bench.tracks.read(), left_m=math.nan)) is None
