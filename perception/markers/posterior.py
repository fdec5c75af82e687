"""Mean and covariance of a faint rover's pose: the likelihood weighed over poses, not its peak's curvature.

Below a joint SNR of some 12 the likelihood is not a parabola within its own sigmas: light's tails widen it,
noise makes it lopsided and gives it shoulders. Poses drawn around the peak and weighed by their likelihood
(importance sampling, with the same quasi-random draws for all) have the mean that errs least and the
covariance that is true.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.stats import norm, qmc

from executive.core.types import Array
from perception.geometry.chain import STATE_SIZE, Chain, ChainState
from perception.geometry.pose import PoseReadings
from perception.kernels.compiled import plain
from perception.kernels.likelihoods import log_likelihoods
from perception.markers.likelihood import (
    Likely,
    MarkerPatches,
    observed_information,
    place_of,
    task_of,
)

_DRAWS = 512  # of each sign
_WIDER = 1.4  # variance drawn over that of the last guess: tails must be drawn to be weighed
_ROUNDS = 3
_LEAST_EFFECTIVE = 4 * STATE_SIZE  # draws that count, below which their covariance is none
_EFFECTIVE = 0.3  # share of draws that must count before moments are believed


def posterior(
    chain: Chain, patches: MarkerPatches, readings: PoseReadings, peak: Likely, shared: bool
) -> tuple[ChainState, Array]:
    """The mean state and the covariance (6, 6) of its body pose, given what found this peak.

    Fluxes are integrated out: one of all markers if `shared`, else one of each that shines. Where the draws
    miss the likelihood, which then is no peak, it is the state found, with the covariance of its curvature.
    """
    task = task_of(chain, patches, readings, peak.flux_counts, shared)
    place = place_of(peak.state, peak.flux_counts)
    curvature = observed_information(chain, patches, readings, peak, shared)
    mean: Array = np.zeros(STATE_SIZE)
    P: Array = np.asarray(np.linalg.inv(curvature), dtype=np.float64)[:STATE_SIZE, :STATE_SIZE]
    for _ in range(_ROUNDS):
        steps = mean + _draws() @ np.linalg.cholesky(_WIDER * (P + P.T) / 2).T
        density = log_likelihoods(task, place, plain(steps))
        log_weight = density + 0.5 * (_draws() ** 2).sum(axis=1)
        weight = np.exp(log_weight - log_weight.max())
        weight /= weight.sum()
        effective = 1.0 / float((weight**2).sum())
        if effective < _LEAST_EFFECTIVE:
            break
        mean = weight @ steps
        P = (steps - mean).T @ ((steps - mean) * weight[:, None])
        if effective >= _EFFECTIVE * len(steps):
            break
    return peak.state.moved(mean), (P + P.T)[:6, :6] / 2


@cache
def _draws() -> Array:
    """Standard normal draws (2 _DRAWS, state), in pairs of opposite sign."""
    sobol = qmc.Sobol(STATE_SIZE, rng=np.random.default_rng(0))
    half = norm.ppf(np.clip(sobol.random(_DRAWS), 1e-9, 1 - 1e-9))
    return np.concatenate([half, -half])
