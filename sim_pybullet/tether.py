"""The tether: massless, straight from the spool to the rover; paid out with a little drag, never rewound.

A rope of links is unstable and dear in Bullet; at these speeds only its pull matters.
"""

from __future__ import annotations

import numpy as np

from executive.core.clock import Clock
from executive.core.types import Array, TetherReading, Vec3
from sim_pybullet.actions import PerTick
from sim_pybullet.lay import Bend

DRAG_N = 0.05
STIFFNESS_N_M = 200.0
SLACK_M = 0.05
LENGTH_SIGMA_M = 0.002
TENSION_SIGMA_N = 0.01


class SimTether:
    """The port, the spool, and the pull on the rover.

    `jammed` stops the spool: then it only stretches. `bend` is where it does not run straight. `tension_n`
    is what pulls at the rover; friction on the way keeps some of it from the sensor at the spool.
    """

    def __init__(
        self, spool_site_m: Vec3, limit_m: float, anchor_site_m: Array, clock: Clock, rng: np.random.Generator
    ) -> None:
        self.spool_site_m = np.array(spool_site_m)
        self._clock, self._rng = clock, rng
        self.limit_m = limit_m
        self.length_m = float(np.linalg.norm(anchor_site_m - self.spool_site_m)) + SLACK_M
        self.tension_n, self._felt_n = 0.0, 0.0
        self.jammed = False
        self.bend: Bend | None = None
        self._past_m = 0.0  # what has slid past the bend
        self._reading = PerTick(self._measure, lambda: clock.ticks)

    def way_m(self, anchor_site_m: Array) -> float:
        """How much of it the way from the spool to the rover takes."""
        before_m, to_bend = self._way(anchor_site_m)
        return before_m + float(np.linalg.norm(to_bend))

    def pull(self, anchor_site_m: Array) -> Array:
        """Pay out if the rover has gone beyond the length; the force on it, to the spool [N], shape (3,)."""
        before_m, toward = self._way(anchor_site_m)
        last_m = float(np.linalg.norm(toward))
        distance_m = before_m + last_m
        caught = self.bend if self.bend is not None and self.bend.caught else None
        free_m = self.length_m if self.jammed or caught else self.limit_m
        if distance_m > free_m:
            stiffness_n_m = caught.stiffness_n_m if caught else STIFFNESS_N_M
            felt_n = DRAG_N + stiffness_n_m * (distance_m - free_m)
        else:
            felt_n = DRAG_N if distance_m >= self.length_m else 0.0
        self.tension_n = self._at_the_rover(felt_n, last_m)
        self._felt_n = felt_n * (caught.felt if caught else 1.0)
        self.length_m = max(self.length_m, min(distance_m, free_m))
        return toward * (self.tension_n / last_m)

    def _at_the_rover(self, felt_n: float, last_m: float) -> float:
        """Behind a bend friction holds what the rover pulls, as far as the capstan goes; it does not pull."""
        if self.bend is None or self.bend.caught:
            self._past_m = 0.0
            return felt_n
        self._past_m = self._past_m or last_m
        tension_n = min(STIFFNESS_N_M * max(0.0, last_m - self._past_m), felt_n * self.bend.capstan)
        self._past_m = max(self._past_m, last_m - tension_n / STIFFNESS_N_M)
        return tension_n

    def _way(self, anchor_site_m: Array) -> tuple[float, Array]:
        """Length up to the last bend [m], and the vector from the rover to it."""
        if self.bend is None:
            return 0.0, self.spool_site_m - anchor_site_m
        bend = np.array(self.bend.at_site_m)
        return float(np.linalg.norm(bend - self.spool_site_m)), bend - anchor_site_m

    def read(self) -> TetherReading:
        """Paid-out length and tension at the spool, with noise."""
        return self._reading.read()

    def _measure(self) -> TetherReading:
        noise = self._rng.standard_normal(2)
        return TetherReading(
            self._clock.now_s,
            self.length_m + LENGTH_SIGMA_M * float(noise[0]),
            max(0.0, self._felt_n + TENSION_SIGMA_N * float(noise[1])),
        )
