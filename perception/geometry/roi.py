"""Regions of interest: windows that hold the markers as far as the prediction is right (paper, 4.1)."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array, Window
from perception.geometry.chain import Chain, ChainState

COVERAGE_SIGMAS = 4.0
_LEAST_SIDE_PX = 48  # room for the point spread and a look at the background
_LARGEST_TURN_RAD = 2.0


def predicted_windows(
    chain: Chain, state: ChainState, pose_covariance: Array, margin_px: float, widen: float = 1.0
) -> tuple[Window, Window] | None:
    """Windows of both cameras around the markers of a predicted state; None if a camera cannot see them.

    `pose_covariance` is the prediction's (6, 6); head and joint accuracy are added here. `margin_px` is left
    around the outermost marker; `widen` scales the uncertainty.
    """
    uv, J = chain.project(state)
    if not np.isfinite(uv).all():
        return None
    P = chain.state_covariance(_turn_capped(pose_covariance, COVERAGE_SIGMAS * widen))
    half = widen * COVERAGE_SIGMAS * _sigma_px(J, P)
    low, high = (uv - half).min(axis=1) - margin_px, (uv + half).max(axis=1) + margin_px
    windows = [_clipped(low[c], high[c], chain.model.size_px[c]) for c in (0, 1)]
    if windows[0] is None or windows[1] is None:
        return None
    return windows[0], windows[1]


def full_windows(chain: Chain) -> tuple[Window, Window]:
    """Both full frames."""
    (wl, hl), (wr, hr) = chain.model.size_px.astype(int).tolist()
    return Window(0, 0, wl, hl), Window(0, 0, wr, hr)


def _sigma_px(J: Array, covariance: Array) -> Array:
    """Standard deviations of column and row (2, n, 2) of Jacobians (2, n, 2, 10)."""
    sigma: Array = np.sqrt(np.einsum("cnik,kl,cnil->cni", J, covariance, J))
    return sigma


def _turn_capped(covariance: Array, sigmas: float) -> Array:
    """The covariance with its rotation scaled so that `sigmas` of it turn by at most 2 rad.

    Turning carries a marker no further than across its circle: 2 radii, which is what 2 rad amount to where
    the chord is taken for linear.
    """
    largest = sigmas * math.sqrt(max(float(np.linalg.eigvalsh(covariance[3:, 3:])[-1]), 0.0))
    scale = np.ones(6)
    scale[3:] = min(1.0, _LARGEST_TURN_RAD / max(largest, 1e-12))
    capped: Array = covariance * np.outer(scale, scale)
    return capped


def _clipped(low: Array, high: Array, size: Array) -> Window | None:
    """The rectangle as whole pixels inside the frame, at least `_LEAST_SIDE_PX` wide; None if outside."""
    if (high < 0).any() or (low > size - 1).any():
        return None
    least = np.minimum(_LEAST_SIDE_PX, size)
    lack = np.maximum(least - (high - low), 0) / 2
    first = np.clip(np.floor(low - lack), 0, size - least).astype(int)
    last = np.clip(np.ceil(high + lack), first + least - 1, size - 1).astype(int)
    return Window(int(first[0]), int(first[1]), int(last[0] - first[0] + 1), int(last[1] - first[1] + 1))
