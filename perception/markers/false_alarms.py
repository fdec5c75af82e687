"""How high noise alone climbs: the threshold of joint detection, for a likelihood that is climbed everywhere.

A lattice has so many places where noise may look like a rover. The climb from its best places searches all
that lies between them too, and over attitude, head and joints as far as their readings let it. What counts
is then the number of poses that the images can tell apart, the volume searched in units of what they
resolve. With information u^2 L in the images of a rover of joint SNR u, P in the readings, and nothing
known of place and heading within their volume V, that is

    n(u) = V (2 pi)^(-3/2) sqrt(det(u^2 L + P) / det(P without place and heading)),

and n(u) Q(u), Q the Gaussian tail, local maxima above u are expected of noise: the leading term of the
expected Euler characteristic of a Gaussian field (Adler and Taylor, Random Fields and Geometry, 2007, 11.7).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtri_exp

from executive.core.types import Array
from perception.frames.psf import Spread
from perception.geometry.chain import STATE_SIZE, Chain, ChainState
from perception.geometry.pose import PoseReadings

_FREE = [0, 1, 5]  # x, y, heading: searched, not read off anything
_READ = [i for i in range(STATE_SIZE) if i not in _FREE]
_FIRST_GUESS = 6.0
_ROUNDS = 8  # each gains a digit
_FINE_PX = 0.1


def joint_threshold(
    chain: Chain,
    state: ChainState,
    readings: PoseReadings,
    spread: Spread,
    volume: float,
    rate: float,
    cameras: Sequence[int] = (0, 1),
) -> float:
    """Joint SNR that noise alone exceeds at `rate` in a search of `volume` [m2 rad] around a state, in
    the images of these cameras.

    ValueError unless the volume is positive and the rate in (0, 1).
    """
    if not (math.isfinite(volume) and volume > 0 and 0 < rate < 1):
        raise ValueError(f"got a volume of {volume} at rate {rate}, expected it positive, in (0, 1)")
    unit = unit_information(chain, state, spread, cameras)
    read = _read(state, readings)
    snr = _FIRST_GUESS
    for _ in range(_ROUNDS):
        snr = -float(ndtri_exp(math.log(rate) - log_distinct_poses(unit, read, volume, snr)))
    return snr


def unit_information(
    chain: Chain, state: ChainState, spread: Spread, cameras: Sequence[int] = (0, 1)
) -> Array:
    """What images of joint SNR 1 say of the state (10, 10), all markers alike."""
    _, J = chain.project(state)
    flat = J[list(cameras)].reshape(-1, STATE_SIZE)
    offsets = np.arange(-spread.radius_px, spread.radius_px, _FINE_PX)  # a marker lies anywhere in its pixel
    sharpness = (spread.profile_slope(offsets) ** 2).sum() / (spread.profile(offsets) ** 2).sum()
    information: Array = sharpness * flat.T @ flat / (len(flat) / 2)
    return information


def log_distinct_poses(unit: Array, read: Array, volume: float, snr: float) -> float:
    """Log of the number of poses, 1 or more, that images of this joint SNR tell apart."""
    log_det = np.linalg.slogdet(snr**2 * unit + read)[1]
    known = np.linalg.slogdet(read[np.ix_(_READ, _READ)])[1]
    return max(math.log(volume) - 1.5 * math.log(2 * math.pi) + 0.5 * float(log_det - known), 0.0)


def _read(state: ChainState, readings: PoseReadings) -> Array:
    """Information (10, 10) of encoders, inclinometers and ground."""
    H = np.zeros((STATE_SIZE, STATE_SIZE))
    readings.add_to(state, H, np.zeros(STATE_SIZE))
    return H
