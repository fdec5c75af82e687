"""What the ground does to tracks: slip under load, turning efficiency, drift on cross slopes, scatter.

Slip follows the track form of the Janosi-Hanamoto law, integrated over the contact length L:
F / F_max = 1 - K / (s L) (1 - exp(-s L / K)), F_max = mu N + c A (Mohr-Coulomb).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.types import Vec2


@dataclass(frozen=True)
class Soil:
    """One kind of ground. Fractions are of 1; scatters are standard deviations of smooth fields over (x, y).

    `yaw_efficiency` is the yaw rate gained over that of ideal tracks; `side_slip` the sideways drift per
    travel and tangent of the cross slope; `shear_m` is K. `sinkage` is the share of all belt travel lost in
    ploughing, whatever the load.
    """

    friction: float
    cohesion_pa: float
    shear_m: float
    yaw_efficiency: float
    yaw_scatter: float
    slip_scatter: float
    side_slip: float
    sinkage: float = 0.0


SOILS: dict[str, Soil] = {
    "crust": Soil(0.80, 100.0, 0.008, 0.72, 0.04, 0.004, 0.10),
    "loose_sand": Soil(0.65, 0.0, 0.015, 0.50, 0.08, 0.010, 0.30),
    "gravel": Soil(0.75, 0.0, 0.010, 0.60, 0.10, 0.008, 0.20),
    "bedrock": Soil(0.90, 0.0, 0.002, 0.85, 0.02, 0.002, 0.02),
}

CONTACT_AREA_M2 = 0.002  # what the grouser tips of one track press into the ground, not its whole footprint


@dataclass(frozen=True)
class Patch:
    """A disc of other soil."""

    at_site_m: Vec2
    radius_m: float
    soil: Soil


def traction_limit(soil: Soil, load_n: float) -> float:
    """Largest thrust of one track under a normal load, Mohr-Coulomb [N]."""
    return soil.friction * load_n + soil.cohesion_pa * CONTACT_AREA_M2


def thrust_ratio(slip: float, length_m: float, shear_m: float) -> float:
    """F / F_max at a slip of 0 to 1."""
    j = slip * length_m / shear_m
    return j / 2 - j * j / 6 if j < 1e-4 else 1 + math.expm1(-j) / j


def slip_for(ratio: float, length_m: float, shear_m: float) -> float:
    """Slip at which a track gives F / F_max = `ratio`, odd in it; +-1 where it cannot.

    Newton on the law above from below its only root: the law is concave, so the steps never pass it.
    """
    wanted = abs(ratio)
    if wanted >= thrust_ratio(1.0, length_m, shear_m):
        return math.copysign(1.0, ratio)
    j = 2 * wanted  # the law bends downwards from j / 2, so this starts below the root
    for _ in range(30):
        decay = math.exp(-j)
        value = j / 2 - j * j / 6 if j < 1e-4 else 1 - (1 - decay) / j
        slope = 0.5 - j / 3 if j < 1e-4 else (1 - decay * (1 + j)) / (j * j)
        step = (wanted - value) / slope
        j += step
        if abs(step) < 1e-10:
            break
    return math.copysign(j * shear_m / length_m, ratio)


class SmoothField:
    """A smooth zero-mean field of unit variance over (x, y): random waves around one correlation length."""

    WAVES = 24

    def __init__(self, correlation_m: float, rng: np.random.Generator) -> None:
        self._wave = rng.standard_normal((self.WAVES, 2)) / correlation_m
        self._phase = rng.uniform(0.0, 2 * math.pi, self.WAVES)
        self._gain = math.sqrt(2.0 / self.WAVES)

    def at(self, x_m: float, y_m: float) -> float:
        """The field's value at a point."""
        waves = np.cos(self._wave[:, 0] * x_m + self._wave[:, 1] * y_m + self._phase)
        return self._gain * float(waves.sum())


CORRELATION_M = 0.25  # about the rover's own length: shorter averages out under it, longer is a soil patch
EDGE_M = 0.05  # patches blend into each other over this width


class SoilMap:
    """Which soil lies where. Patches may be added while the world runs; later ones cover earlier ones."""

    def __init__(self, default: Soil, patches: tuple[Patch, ...], rng: np.random.Generator) -> None:
        self.default = default
        self.patches = list(patches)
        self._slip = SmoothField(CORRELATION_M, rng)
        self._yaw = SmoothField(CORRELATION_M, rng)

    def at(self, x_m: float, y_m: float) -> Soil:
        """The soil at a point, scatter not included."""
        soil = self.default
        for patch in self.patches:
            distance_m = math.hypot(x_m - patch.at_site_m[0], y_m - patch.at_site_m[1])
            soil = _blend(soil, patch.soil, (patch.radius_m - distance_m) / EDGE_M + 0.5)
        return soil

    def slip_scatter(self, soil: Soil, x_m: float, y_m: float) -> float:
        """Slip to add at this place."""
        return soil.slip_scatter * self._slip.at(x_m, y_m)

    def yaw_efficiency(self, soil: Soil, x_m: float, y_m: float) -> float:
        """The yaw efficiency at this place, scatter included, kept between 5 % and 100 %."""
        return min(1.0, max(0.05, soil.yaw_efficiency + soil.yaw_scatter * self._yaw.at(x_m, y_m)))


def _blend(under: Soil, over: Soil, share: float) -> Soil:
    if share <= 0.0:
        return under
    if share >= 1.0:
        return over
    return Soil(*(a + (b - a) * share for a, b in zip(_fields(under), _fields(over), strict=True)))


def _fields(soil: Soil) -> tuple[float, ...]:
    return (
        soil.friction,
        soil.cohesion_pa,
        soil.shear_m,
        soil.yaw_efficiency,
        soil.yaw_scatter,
        soil.slip_scatter,
        soil.side_slip,
        soil.sinkage,
    )
