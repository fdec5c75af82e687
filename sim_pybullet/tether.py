"""The tether: massless, straight from the spool to the rover; paid out with a little drag, never rewound.

A rope of links is unstable and dear in Bullet; at these speeds only its pull matters.
"""

from __future__ import annotations

import numpy as np

from executive.clock import Clock
from executive.types import Array, TetherReading, Vec3
from sim_pybullet.actions import PerTick

DRAG_N = 0.05
STIFFNESS_N_M = 200.0
SLACK_M = 0.05
LENGTH_SIGMA_M = 0.002
TENSION_SIGMA_N = 0.01


class SimTether:
    """The port, the spool, and the pull on the rover. `jammed` stops the spool: then it only stretches."""

    def __init__(
        self, spool_site_m: Vec3, limit_m: float, anchor_site_m: Array, clock: Clock, rng: np.random.Generator
    ) -> None:
        self._spool = np.array(spool_site_m)
        self._limit_m, self._clock, self._rng = limit_m, clock, rng
        self.length_m = float(np.linalg.norm(anchor_site_m - self._spool)) + SLACK_M
        self.tension_n = 0.0
        self.jammed = False
        self._reading = PerTick(self._measure, lambda: clock.ticks)

    def pull(self, anchor_site_m: Array) -> Array:
        """Pay out if the rover has gone beyond the length; the force on it, to the spool [N], shape (3,)."""
        to_spool = self._spool - anchor_site_m
        distance_m = float(np.linalg.norm(to_spool))
        free_m = self.length_m if self.jammed else self._limit_m
        if distance_m > free_m:
            self.tension_n = DRAG_N + STIFFNESS_N_M * (distance_m - free_m)
        else:
            self.tension_n = DRAG_N if distance_m >= self.length_m else 0.0
        self.length_m = max(self.length_m, min(distance_m, free_m))
        return to_spool * (self.tension_n / distance_m)

    def read(self) -> TetherReading:
        """Paid-out length and tension at the spool, with noise."""
        return self._reading.read()

    def _measure(self) -> TetherReading:
        noise = self._rng.standard_normal(2)
        return TetherReading(
            self._clock.now_s,
            self.length_m + LENGTH_SIGMA_M * float(noise[0]),
            max(0.0, self.tension_n + TENSION_SIGMA_N * float(noise[1])),
        )
