"""Everything measured besides pixels, as shares of the normal equations over a state of ten."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from executive.core.types import Array
from perception.kernels.compiled import compiled
from perception.kernels.rotations import log_map

_LEVEL_FLOOR = 1e-12  # of a rover on its nose, whose roll is not defined


class WeightedReadings(NamedTuple):
    """Readings with their weights (inverse variances), zero where there is none.

    encoder_rad (4,) as (pan, tilt, arm, cabin), tilt_rad (2,) as (roll, pitch), a prior pose with its weight
    (6, 6).
    """

    encoder_rad: Array
    encoder_weight: Array
    tilt_rad: Array
    tilt_weight: float
    prior_rotation: Array
    prior_position_m: Array
    prior_weight: Array


@compiled
def roll_pitch(rotation: Array) -> tuple[float, float, Array]:
    """Inclinometer readings of an attitude Rz(yaw) Ry(pitch) Rx(roll), and their derivative (2, 3) by a small
    rotation vector in site."""
    x, y, z = rotation[2, 0], rotation[2, 1], rotation[2, 2]  # the vertical, seen from the body
    roll, pitch = math.atan2(y, z), -math.asin(min(max(x, -1.0), 1.0))
    level = max(y * y + z * z, _LEVEL_FLOOR)
    by_turn = np.zeros((2, 3))
    for i in range(2):
        side = rotation[1] if i == 0 else -rotation[0]
        by_turn[0, i] = (z * side[1] - y * side[2]) / level
        by_turn[1, i] = -side[0] / math.sqrt(level)
    return roll, pitch, by_turn


@compiled
def add_readings(
    measured: WeightedReadings, rotation: Array, position_m: Array, angles: Array, H: Array, g: Array
) -> float:
    """Add the readings at a state to its normal equations in place; returns their share of chi-square."""
    cost = 0.0
    for i in range(4):
        weight, off = measured.encoder_weight[i], measured.encoder_rad[i] - angles[i]
        H[6 + i, 6 + i] += weight
        g[6 + i] += weight * off
        cost += weight * off * off
    if measured.tilt_weight > 0:
        cost += _add_tilt(measured, rotation, H, g)
    return cost + _add_prior(measured, rotation, position_m, H, g)


@compiled
def _add_tilt(measured: WeightedReadings, rotation: Array, H: Array, g: Array) -> float:
    roll, pitch, J = roll_pitch(rotation)
    off_roll, off_pitch = measured.tilt_rad[0] - roll, measured.tilt_rad[1] - pitch
    for i in range(3):
        g[3 + i] += measured.tilt_weight * (J[0, i] * off_roll + J[1, i] * off_pitch)
        for j in range(3):
            H[3 + i, 3 + j] += measured.tilt_weight * (J[0, i] * J[0, j] + J[1, i] * J[1, j])
    cost: float = measured.tilt_weight * (off_roll * off_roll + off_pitch * off_pitch)
    return cost


@compiled
def _add_prior(measured: WeightedReadings, rotation: Array, position_m: Array, H: Array, g: Array) -> float:
    if not measured.prior_weight.any():
        return 0.0
    off, turned, cost = np.empty(6), np.empty((3, 3)), 0.0
    for i in range(3):
        off[i] = measured.prior_position_m[i] - position_m[i]
        for j in range(3):
            turned[i, j] = 0.0
            for k in range(3):
                turned[i, j] += measured.prior_rotation[i, k] * rotation[j, k]
    off[3:] = log_map(turned)
    for i in range(6):
        pull = 0.0
        for j in range(6):
            H[i, j] += measured.prior_weight[i, j]
            pull += measured.prior_weight[i, j] * off[j]
        g[i] += pull
        cost += off[i] * pull
    return cost
