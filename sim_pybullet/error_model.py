"""How well the full tier finds a marker, as a function of its filter SNR: measured, for the cheap tier.

The centre's error is the Cramér-Rao bound of the marker's own spread times a measured factor; whether it is
found at all is a measured probability. `benchmarks/error_model.py` prints both from simulated images run
through the detector of the perception package (windows of 96 px, false-alarm rate 1e-3 a window).

In a coded shot (several LEDs on at once) the markers are not found one by one but all together or not at
all; `benchmarks/perception.py` prints how often, and how far above the bound their pose is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from executive.core.ordered_sum import ordered_sum
from sim_pybullet.leds import Spot
from sim_pybullet.radiometry import Exposure, line_spread, spread_reach_px

# filter SNR, share of markers found, RMS centre error of those found over the bound (both axes together)
MEASURED = (
    (2.0, 0.00, 0.70),
    (3.0, 0.02, 0.80),
    (4.0, 0.15, 0.92),
    (5.0, 0.44, 0.96),
    (6.0, 0.79, 1.05),
    (7.0, 0.95, 1.04),
    (8.0, 0.99, 1.03),
    (10.0, 1.00, 1.02),
    (15.0, 1.00, 1.00),
    (100.0, 1.00, 1.00),
)
JOINT_THRESHOLD = 5.8  # joint SNR above which a coded shot shows the rover; noise adds 1 to it
JOINT_EXCESS = 1.05  # error over bound of what it shows
FLOOR_PX = 0.01  # what the detector adds for the lens calibration's own error


@dataclass(frozen=True)
class CentreError:
    """What to expect of one marker in one camera: filter SNR, chance to be found, errors [px].

    `sigma_u_px` and `sigma_v_px` are the true standard deviations, `reported_px` what the detector says.
    """

    snr: float
    found: float
    sigma_u_px: float
    sigma_v_px: float
    reported_px: float


def centre_error(
    spot: Spot, exposure: Exposure, lit_frames: int, dark_frames: int, factor: float | None = None
) -> CentreError:
    """The error of a marker found in the mean of its lit frames less the mean of the dark ones.

    `factor` replaces the measured ratio of error to bound.
    """
    if spot.electrons <= 0 or lit_frames < 1 or dark_frames < 1:
        return CentreError(0.0, 0.0, math.inf, math.inf, math.inf)
    noise_e = exposure.noise_counts * exposure.gain_e * math.sqrt(1 / lit_frames + 1 / dark_frames)
    (line_u, slope_u), (line_v, slope_v) = (_line(spot, centre) for centre in (spot.u_px, spot.v_px))
    scale = spot.electrons / noise_e
    snr = scale * math.sqrt(line_u * line_v)
    bound_u, bound_v = 1 / (scale * math.sqrt(slope_u * line_v)), 1 / (scale * math.sqrt(line_u * slope_v))
    at, found, excess = (np.array(column) for column in zip(*MEASURED, strict=True))
    above = float(np.interp(snr, at, excess)) if factor is None else factor
    return CentreError(
        snr,
        float(np.interp(snr, at, found)),
        above * bound_u,
        above * bound_v,
        math.hypot(math.sqrt(bound_u * bound_v), FLOOR_PX),
    )


def joint_chance(errors: Sequence[CentreError]) -> float:
    """Chance that a coded shot shows all markers at once, from one camera; the other sees the same."""
    joint_snr = math.sqrt(2 * ordered_sum(error.snr**2 for error in errors))
    return float(ndtr(joint_snr - JOINT_THRESHOLD))


def _line(spot: Spot, centre_px: float) -> tuple[float, float]:
    """Sums of squares of the spot's profile along one axis and of its slope [1/px]."""
    reach = spread_reach_px(spot.size_px, spot.sigma_px)
    offset = np.arange(-reach, reach + 1) + round(centre_px) - centre_px
    step = 1e-3
    profile = line_spread(offset, spot.size_px, spot.sigma_px)
    ahead = line_spread(offset + step, spot.size_px, spot.sigma_px)
    behind = line_spread(offset - step, spot.size_px, spot.sigma_px)
    slope = (ahead - behind) / (2 * step)
    return float((profile**2).sum()), float((slope**2).sum())
