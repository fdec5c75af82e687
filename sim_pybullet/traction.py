"""From belt travel to rover travel: slip under load, scatter, turning efficiency, drift on cross slopes."""

from __future__ import annotations

from dataclasses import dataclass

from executive.core.types import Array
from sim_pybullet.soil import Soil, slip_for, traction_limit


@dataclass(frozen=True)
class Load:
    """What presses and pulls on the rover, in `body` axes [N]; gravity and tether, not obstacles."""

    ahead_n: float
    left_n: float
    down_n: float

    @classmethod
    def of(cls, rotation_site_body: Array, weight_n: float, tether_site_n: Array) -> Load:
        """Weight and tether pull, turned into `body`."""
        pull = tether_site_n.copy()
        pull[2] -= weight_n
        x, y, z = rotation_site_body.T @ pull
        return cls(float(x), float(y), max(float(-z), 1e-6))

    def resistance(self, soil: Soil) -> float:
        """Share of a track's largest thrust that moving ahead takes; each track bears half of everything."""
        return -self.ahead_n / 2 / traction_limit(soil, self.down_n / 2)


@dataclass(frozen=True)
class TrackGround:
    """What one track stands on: its soil, the slip scatter at its place, and the contact length."""

    soil: Soil
    scatter: float
    length_m: float

    def travel(self, belt_m: float, load: Load) -> float:
        """How far the ground lets a track carry for this belt travel (signed) [m]."""
        slip = slip_for(load.resistance(self.soil), self.length_m, self.soil.shear_m)
        return belt_m - abs(belt_m) * slip - belt_m * self.scatter

    def slip(self, belt_m: float, load: Load) -> float:
        """Share of this belt travel that is lost; 0 for no travel."""
        return 0.0 if belt_m == 0.0 else 1.0 - self.travel(belt_m, load) / belt_m


@dataclass(frozen=True)
class Displacement:
    """A small motion of the body in its own axes: ahead and to the left [m], turning left [rad]."""

    ahead_m: float
    left_m: float
    turn_rad: float


def displacement(
    belts_m: tuple[float, float],
    grounds: tuple[TrackGround, TrackGround],
    load: Load,
    yaw_efficiency: float,
    gauge_m: float,
    side_drift: float = 0.0,
) -> Displacement:
    """What the rover does for these belt travels of its left and right track.

    `side_drift` is how far it slides to the left per travel, besides what the slope makes it.
    """
    left_m, right_m = (g.travel(b, load) for g, b in zip(grounds, belts_m, strict=True))
    side_slip = (grounds[0].soil.side_slip + grounds[1].soil.side_slip) / 2
    drift_m = (side_slip * load.left_n / load.down_n + side_drift) * (abs(belts_m[0]) + abs(belts_m[1])) / 2
    return Displacement((left_m + right_m) / 2, drift_m, yaw_efficiency * (right_m - left_m) / gauge_m)
