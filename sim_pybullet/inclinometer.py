"""The inclinometers: the body's roll and pitch, with noise."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from executive.core.clock import Clock
from executive.core.types import Array, TiltReading
from sim_pybullet.actions import PerTick


def roll_pitch(rotation_site_body: Array) -> tuple[float, float]:
    """Rotation about body x and y, R = Rz(yaw) Ry(pitch) Rx(roll); pitch positive nose-down [rad]."""
    r = rotation_site_body
    return math.atan2(float(r[2, 1]), float(r[2, 2])), -math.asin(max(-1.0, min(1.0, float(r[2, 0]))))


class SimInclinometer:
    """The port. `true_rotation` gives R_site_body."""

    def __init__(
        self, sigma_rad: float, clock: Clock, rng: np.random.Generator, true_rotation: Callable[[], Array]
    ) -> None:
        self._sigma_rad, self._clock, self._rng, self._rotation = sigma_rad, clock, rng, true_rotation
        self._reading = PerTick(self._measure, lambda: clock.ticks)

    def read(self) -> TiltReading:
        return self._reading.read()

    def _measure(self) -> TiltReading:
        noise = self._rng.standard_normal(2) * self._sigma_rad
        roll, pitch = roll_pitch(self._rotation())
        return TiltReading(self._clock.now_s, roll + float(noise[0]), pitch + float(noise[1]))
