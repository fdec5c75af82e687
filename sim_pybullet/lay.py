"""How the tether lies: straight from the spool, or round something on the ground, caught there or sliding."""

from __future__ import annotations

from dataclasses import dataclass

from executive.core.types import Vec3


@dataclass(frozen=True)
class Bend:
    """Where the tether bends on its way to the rover.

    Sliding round it multiplies the pull at the spool by `capstan` (e to the friction times the angle of
    wrap); what does not slide stretches instead. Where it is `caught`, it only stretches from here on, by
    1 / `stiffness_n_m`, and the sensor at the spool feels the share `felt` of it.
    """

    at_site_m: Vec3
    capstan: float = 1.0
    caught: bool = False
    stiffness_n_m: float = 200.0
    felt: float = 1.0
