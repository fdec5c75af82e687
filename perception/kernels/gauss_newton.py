"""Gauss-Newton over the chain (paper, eqs. 6-11): the pose that centres and readings have together."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from executive.core.types import Array
from perception.kernels.chain import STATE_SIZE, CabinChain, HeadChain, project
from perception.kernels.compiled import compiled
from perception.kernels.linear import factor, inverted, solve
from perception.kernels.optics import Optics
from perception.kernels.readings import WeightedReadings, add_readings
from perception.kernels.rotations import moved

_MAX_STEPS = 20
_CONVERGED = 1e-7  # m and rad
_MAX_TURN_RAD = 0.5  # longest rotation of one step


class PoseProblem(NamedTuple):
    """The rig, its markers (n, 3), the readings, and centres (c, n, 2) with weights (c, n, 2, 2)."""

    optics: Optics
    head: HeadChain
    cabin: CabinChain
    markers_plc_m: Array
    measured: WeightedReadings
    uv_px: Array
    weights: Array


class PoseFit(NamedTuple):
    """A state with its body's covariance (6, 6), chi-square, pixels (c, n, 2) and what measured ones are off
    them, NaN where not seen."""

    rotation: Array
    position_m: Array
    angles_rad: Array
    covariance: Array
    chi2: float
    steps: int
    converged: bool
    reprojected_px: Array
    residual_px: Array


@compiled
def weights_of(uv_px: Array, covariance_px2: Array) -> tuple[Array, int]:
    """Inverse covariances (c, n, 2, 2) of centres, zero where one is not seen, and how many are."""
    weights, seen = np.zeros_like(covariance_px2), 0
    for c in range(len(uv_px)):
        for k in range(uv_px.shape[1]):
            P = covariance_px2[c, k]
            if math.isfinite(uv_px[c, k].sum()) and math.isfinite(P.sum()):
                det = P[0, 0] * P[1, 1] - P[0, 1] * P[1, 0]
                weights[c, k, 0, 0], weights[c, k, 1, 1] = P[1, 1] / det, P[0, 0] / det
                weights[c, k, 0, 1], weights[c, k, 1, 0] = -P[0, 1] / det, -P[1, 0] / det
                seen += 1
    return weights, seen


@compiled
def normal_equations(
    problem: PoseProblem, rotation: Array, position_m: Array, angles: Array
) -> tuple[Array, Array, float]:
    """Information (10, 10), its lower half, right-hand side (10,), chi-square at a state (eqs. 10, 11)."""
    optics, head, cabin, markers_plc_m, measured, uv_px, weights = problem
    uv, J = project(optics, head, cabin, markers_plc_m, rotation, position_m, angles)
    H, g = np.zeros((STATE_SIZE, STATE_SIZE)), np.zeros(STATE_SIZE)
    cost = add_readings(measured, rotation, position_m, angles, H, g)
    for c in range(len(uv)):
        for k in range(uv.shape[1]):
            W, by_u, by_v = weights[c, k], J[c, k, 0], J[c, k, 1]
            if W[0, 0] == 0.0:  # not seen
                continue
            off_u, off_v = uv_px[c, k, 0] - uv[c, k, 0], uv_px[c, k, 1] - uv[c, k, 1]
            cost += off_u * (W[0, 0] * off_u + W[0, 1] * off_v) + off_v * (W[1, 0] * off_u + W[1, 1] * off_v)
            for i in range(STATE_SIZE):
                weighted_u = W[0, 0] * by_u[i] + W[1, 0] * by_v[i]
                weighted_v = W[0, 1] * by_u[i] + W[1, 1] * by_v[i]
                g[i] += weighted_u * off_u + weighted_v * off_v
                for j in range(i + 1):
                    H[i, j] += weighted_u * by_u[j] + weighted_v * by_v[j]
    return H, g, cost


@compiled
def gauss_newton(problem: PoseProblem, rotation: Array, position_m: Array, angles: Array) -> PoseFit:
    """The state that fits best, from a start (rotation, position, angles)."""
    H, g, cost = normal_equations(problem, rotation, position_m, angles)
    longest, steps = math.inf, 0
    while steps < _MAX_STEPS and not longest < _CONVERGED:
        steps += 1
        step = _limited(H, g)
        turned, shifted, aimed = _stepped(rotation, position_m, angles, step)
        H, g, cost_new = normal_equations(problem, turned, shifted, aimed)
        longest = np.abs(step).max()
        while not cost_new <= cost + 1e-9 * (1 + cost) and longest > _CONVERGED:
            step /= 4
            turned, shifted, aimed = _stepped(rotation, position_m, angles, step)
            H, g, cost_new = normal_equations(problem, turned, shifted, aimed)
            longest = np.abs(step).max()
        rotation, position_m, angles, cost = turned, shifted, aimed, cost_new
    converged = longest < _CONVERGED and math.isfinite(cost)
    optics, head, cabin, markers, _, uv_px, weights = problem
    uv, _ = project(optics, head, cabin, markers, rotation, position_m, angles)
    residual = np.full(uv.shape, math.nan)
    for c in range(len(uv)):
        for k in range(uv.shape[1]):
            if weights[c, k, 0, 0] != 0.0:
                residual[c, k] = uv_px[c, k] - uv[c, k]
    return PoseFit(rotation, position_m, angles, inverted(H, 6), cost, steps, converged, uv, residual)


@compiled
def _stepped(rotation: Array, position_m: Array, angles: Array, step: Array) -> tuple[Array, Array, Array]:
    turned, shifted = moved(rotation, position_m, step)
    return turned, shifted, angles + step[6:]


@compiled
def _limited(H: Array, g: Array) -> Array:
    """The step that solves H step = g, shortened to `_MAX_TURN_RAD`, for starts far away."""
    factor(H)
    step = g.copy()
    solve(H, step)
    turn = math.sqrt(step[3] * step[3] + step[4] * step[4] + step[5] * step[5])
    if turn > _MAX_TURN_RAD:
        step *= _MAX_TURN_RAD / turn
    return step
