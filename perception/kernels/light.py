"""A marker's light over pixels, and what difference images say of its flux and place."""

from __future__ import annotations

import math

import numpy as np

from executive.types import Array
from perception.kernels.compiled import compiled


@compiled
def profile(offset_px: float, box_px: float, sigma_px: float) -> tuple[float, float]:
    """Share of a blurred square's light in a pixel at this offset, in one axis, and its slope [1/px].

    Convolving box, pixel and Gaussian gives the second difference of H, the Gaussian's second integral.
    """
    outer, inner = (box_px + 1) / 2, (box_px - 1) / 2
    share_0, slope_0 = _integrals(offset_px + outer, sigma_px)
    share_1, slope_1 = _integrals(offset_px + inner, sigma_px)
    share_2, slope_2 = _integrals(offset_px - inner, sigma_px)
    share_3, slope_3 = _integrals(offset_px - outer, sigma_px)
    return (
        (share_0 - share_1 - share_2 + share_3) / box_px,
        (slope_0 - slope_1 - slope_2 + slope_3) / box_px,
    )


@compiled
def _integrals(t: float, sigma_px: float) -> tuple[float, float]:
    """The Gaussian's second and first integral."""
    x = t / sigma_px
    first = 0.5 * math.erfc(-x / math.sqrt(2.0))
    return t * first + sigma_px * math.exp(-0.5 * x * x) / math.sqrt(2 * math.pi), first


@compiled
def profiles(offsets_px: Array, box_px: float, sigma_px: float) -> tuple[Array, Array]:
    """Shares and slopes (n,) at offsets (n,)."""
    shares, slopes = np.empty(len(offsets_px)), np.empty(len(offsets_px))
    for k in range(len(offsets_px)):
        shares[k], slopes[k] = profile(offsets_px[k], box_px, sigma_px)
    return shares, slopes


@compiled
def local_fits(
    images: Array,
    weights: Array,
    corner_px: Array,
    uv_px: Array,
    flux: Array,
    box_px: float,
    sigma_px: float,
    reach: int,
) -> tuple[Array, Array, float]:
    """One camera's markers: information (n, 3, 3) and score (n, 3) of (flux, column, row), and twice the gain
    in log likelihood, from patches within `reach` of the pixels (n, 2) where markers of fluxes (n,) are.

    Images and inverse variances (n, h, w) [counts] start at `corner_px`; a patch off them says nothing.
    """
    information, score, gain = np.zeros((len(flux), 3, 3)), np.zeros((len(flux), 3)), 0.0
    height, width = images.shape[1:]
    T = np.empty(3)
    for m in range(len(flux)):
        if not math.isfinite(uv_px[m, 0] + uv_px[m, 1]):
            continue
        middle_u, middle_v = np.rint(uv_px[m, 0]), np.rint(uv_px[m, 1])
        left, top = int(middle_u - corner_px[0]) - reach, int(middle_v - corner_px[1]) - reach
        if left < 0 or top < 0 or left + 2 * reach >= width or top + 2 * reach >= height:
            continue
        steps = np.arange(-reach, reach + 1)
        across, across_slope = profiles(steps + (middle_u - uv_px[m, 0]), box_px, sigma_px)
        down, down_slope = profiles(steps + (middle_v - uv_px[m, 1]), box_px, sigma_px)
        for j in range(2 * reach + 1):
            for i in range(2 * reach + 1):
                pixel, weight = images[m, top + j, left + i], weights[m, top + j, left + i]
                T[0] = down[j] * across[i]
                T[1] = -flux[m] * down[j] * across_slope[i]
                T[2] = -flux[m] * down_slope[j] * across[i]
                rest = pixel - flux[m] * T[0]
                gain += weight * (pixel * pixel - rest * rest)
                for a in range(3):
                    weighted = weight * T[a]
                    score[m, a] += weighted * rest
                    for b in range(3):
                        information[m, a, b] += weighted * T[b]
    return information, score, gain


@compiled
def joined(J: Array, light_by_flux: Array, information: Array, score: Array) -> tuple[Array, Array]:
    """Information (s, s) and gradient (s,) over the state of ten and the fluxes, from local fits.

    J (c, n, 2, 10) are the pixels by the state, `light_by_flux` (c, n, k) each marker's light by the fluxes.
    """
    cameras, n, _, states = J.shape
    size = states + light_by_flux.shape[2]
    H, g, G, weighted = np.zeros((size, size)), np.zeros(size), np.zeros((3, size)), np.empty((3, size))
    for c in range(cameras):
        for m in range(n):
            for s in range(states):
                G[1, s], G[2, s] = J[c, m, 0, s], J[c, m, 1, s]
            for s in range(states, size):
                G[0, s] = light_by_flux[c, m, s - states]
            for a in range(3):
                for s in range(size):
                    weighted[a, s] = 0.0
                    for b in range(3):
                        weighted[a, s] += information[c, m, a, b] * G[b, s]
            for s in range(size):
                for a in range(3):
                    g[s] += G[a, s] * score[c, m, a]
                    for t in range(size):
                        H[s, t] += G[a, s] * weighted[a, t]
    return H, g
