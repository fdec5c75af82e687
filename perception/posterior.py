"""Mean and covariance of a faint rover's pose: the likelihood weighed over poses, not its peak's curvature.

Below a joint SNR of some 12 the likelihood is not a parabola within its own sigmas: light's tails widen it,
noise makes it lopsided and gives it shoulders. Poses drawn around the peak and weighed by their likelihood
(importance sampling, with the same quasi-random draws for all) have the mean that errs least and the
covariance that is true.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, qmc

from executive.types import Array
from perception.chain import STATE_SIZE, Chain, ChainState
from perception.likelihood import Evidence, Likely, local_fits, observed_information
from perception.pose import Readings

_DRAWS = 512  # of each sign
_WIDER = 1.4  # variance drawn over that of the last guess: tails must be drawn to be weighed
_ROUNDS = 3
_EFFECTIVE = 0.3  # share of draws that must count before moments are believed


def posterior(
    chain: Chain, evidence: Evidence, readings: Readings, peak: Likely, shared: bool
) -> tuple[ChainState, Array]:
    """The mean state and the covariance (6, 6) of its body pose, given what found this peak.

    Fluxes are integrated out: one of all markers if `shared`, else one of each that shines. Both are
    bit-for-bit the same for the same input.
    """
    lit = peak.flux_counts > 0
    curvature = observed_information(chain, evidence, readings, peak, shared)
    mean: Array = np.zeros(STATE_SIZE)
    P: Array = np.asarray(np.linalg.inv(curvature), dtype=np.float64)[:STATE_SIZE, :STATE_SIZE]
    for _ in range(_ROUNDS):
        steps = mean + _draws() @ np.linalg.cholesky(_WIDER * (P + P.T) / 2).T
        log_density = np.array(
            [log_likelihood(chain, evidence, readings, peak.state.moved(s), lit, shared) for s in steps]
        )
        log_weight = log_density + 0.5 * (_draws() ** 2).sum(axis=1)
        weight = np.exp(log_weight - log_weight.max())
        weight /= weight.sum()
        mean = weight @ steps
        P = (steps - mean).T @ ((steps - mean) * weight[:, None])
        if 1.0 / float((weight**2).sum()) >= _EFFECTIVE * len(steps):
            break
    return peak.state.moved(mean), (P + P.T)[:6, :6] / 2


def log_likelihood(
    chain: Chain,
    evidence: Evidence,
    readings: Readings,
    state: ChainState,
    lit: NDArray[np.bool_],
    shared: bool,
) -> float:
    """Log likelihood of a state, of the best fluxes of the markers in `lit` (n,)."""
    uv, _ = chain.project(state)
    local = local_fits(evidence, uv, np.zeros(len(lit)))
    power = (local.information[..., 0, 0] * evidence.gain**2)[:, lit].sum(axis=0)
    pull = (local.score[..., 0] * evidence.gain)[:, lit].sum(axis=0)
    if shared:
        power, pull = power.sum(keepdims=True), pull.sum(keepdims=True)
    light = float((np.maximum(pull, 0.0) ** 2 / np.maximum(power, 1e-30)).sum())
    return 0.5 * (light - readings.add_to(state, np.zeros((STATE_SIZE, STATE_SIZE)), np.zeros(STATE_SIZE)))


@cache
def _draws() -> Array:
    """Standard normal draws (2 _DRAWS, state), in pairs of opposite sign."""
    sobol = qmc.Sobol(STATE_SIZE, rng=np.random.default_rng(0))
    half = norm.ppf(np.clip(sobol.random(_DRAWS), 1e-9, 1 - 1e-9))
    return np.concatenate([half, -half])
