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

from executive.types import Array
from perception.chain import STATE_SIZE, Chain, ChainState
from perception.kernels.compiled import plain
from perception.kernels.likelihoods import Light, Seen
from perception.kernels.likelihoods import log_likelihoods as kernel
from perception.likelihood import Evidence, Likely, flux_groups, observed_information, patch_radius
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
    curvature = observed_information(chain, evidence, readings, peak, shared)
    mean: Array = np.zeros(STATE_SIZE)
    P: Array = np.asarray(np.linalg.inv(curvature), dtype=np.float64)[:STATE_SIZE, :STATE_SIZE]
    for _ in range(_ROUNDS):
        steps = mean + _draws() @ np.linalg.cholesky(_WIDER * (P + P.T) / 2).T
        density = log_likelihoods(chain, evidence, readings, peak, shared, steps)
        log_weight = density + 0.5 * (_draws() ** 2).sum(axis=1)
        weight = np.exp(log_weight - log_weight.max())
        weight /= weight.sum()
        mean = weight @ steps
        P = (steps - mean).T @ ((steps - mean) * weight[:, None])
        if 1.0 / float((weight**2).sum()) >= _EFFECTIVE * len(steps):
            break
    return peak.state.moved(mean), (P + P.T)[:6, :6] / 2


def log_likelihoods(
    chain: Chain, evidence: Evidence, readings: Readings, peak: Likely, shared: bool, steps: Array
) -> Array:
    """Log likelihoods (k,) of the peak's state moved by steps (k, 10), of the best fluxes of what shines."""
    body, spread = peak.state.site_body, evidence.spread
    cameras = evidence.images, evidence.weights, evidence.corners_px, evidence.gain
    left, right = (Seen(*camera) for camera in zip(*cameras, strict=True))
    return kernel(
        *chain.kernel_rig,
        readings.measured,
        left,
        right,
        Light(spread.box_px, spread.sigma_px, patch_radius(spread)),
        plain(flux_groups(peak.flux_counts, shared)),
        plain(body.rotation),
        plain(body.position_m),
        peak.state.angles_rad,
        plain(steps),
    )


@cache
def _draws() -> Array:
    """Standard normal draws (2 _DRAWS, state), in pairs of opposite sign."""
    sobol = qmc.Sobol(STATE_SIZE, rng=np.random.default_rng(0))
    half = norm.ppf(np.clip(sobol.random(_DRAWS), 1e-9, 1 - 1e-9))
    return np.concatenate([half, -half])
