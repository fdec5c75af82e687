"""The exposure follows the light: down until the wells are not full, and up again when the light has gone."""

from __future__ import annotations

import numpy as np
import pytest

from executive.core.clock import Clock
from executive.core.devices import CAMERAS
from executive.core.ports import Devices
from executive.core.rig import RigCalibration
from executive.core.types import (
    Centres,
    HeadReading,
    Images,
    Outcome,
    Reason,
    Window,
)
from perception.frames.metering import Metering

WINDOWS = (Window(0, 0, 40, 30),) * 2
HEAD = HeadReading(0.0, 0.0, 0.0, False)


class Cameras:
    """Ground of `light` times the light that the cameras are set for, in images or as the cheap tier says."""

    def __init__(self, light: float, geometric: bool) -> None:
        self.light, self.geometric, self.taken = light, geometric, 0

    def take(self, shot):
        self.taken += 1
        count = 0.4 * 1023 * self.light * shot.exposure
        if self.geometric:
            nothing = np.full((2, 4, 2), np.nan)
            full = count >= 1023
            self._data = Centres(0.0, shot, nothing, nothing[..., 0], HEAD, saturated=(full, full))
        else:
            stack = np.full((len(shot.leds), 30, 40), min(count, 1023), dtype=np.uint16)
            self._data = Images(0.0, shot, WINDOWS, (stack, stack), HEAD)
        return self

    def poll(self):
        return Outcome(Reason.DONE, value=self._data)

    def cancel(self):
        pass


def metering(cameras):
    return Metering(Devices(CAMERAS.fit(cameras)), RigCalibration(), Clock())


def measured(light):
    steps = light.measure(WINDOWS, 100.0)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


@pytest.mark.parametrize("geometric", [False, True])
@pytest.mark.parametrize(("light", "exposure"), [(0.3, 1.0), (1.0, 1.0), (3.5, 0.5), (20.0, 0.0625)])
def test_the_longest_exposure_that_fills_no_well_is_taken(light, exposure, geometric):
    found = metering(Cameras(light, geometric))
    assert measured(found)
    assert found.exposure == exposure
    assert found.pairs_factor >= exposure**-2


def test_light_that_drowns_the_shortest_exposure_is_said():
    found = metering(Cameras(100.0, geometric=False))
    assert not measured(found)


def test_once_the_light_has_gone_the_exposure_is_whole_again():
    cameras = Cameras(3.5, geometric=True)
    found = metering(cameras)
    measured(found)
    cameras.light = 1.0
    assert measured(found)
    assert found.exposure == 1.0
    assert found.pairs_factor == 1.0
