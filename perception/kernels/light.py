"""A marker's light over pixels, and what difference images say of its flux and place."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array
from perception.kernels.compiled import compiled
from perception.kernels.linear import factor, solve

_FIT_STEPS = 12
_MAX_STEP_PX = 0.7
_CONVERGED_PX = 1e-4
_MAX_WANDER_PX = 2.0


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
def add_fit(
    image: Array,
    weights: Array,
    patch: tuple[int, int, int, int],
    u_px: float,
    v_px: float,
    flux: float,
    box_px: float,
    sigma_px: float,
    information: Array,
    score: Array,
) -> float:
    """Add to information (3, 3) and score (3,) of (flux, column, row) what a patch (left, top, width, height)
    of an image (h, w) [counts] says of a marker at (u, v) in it; returns twice the gain in log likelihood.

    `weights` are the pixels' inverse variances.
    """
    left, top, width, height = patch
    across, across_slope = profiles(np.arange(width, dtype=np.float64) + (left - u_px), box_px, sigma_px)
    down, down_slope = profiles(np.arange(height, dtype=np.float64) + (top - v_px), box_px, sigma_px)
    T, gain = np.empty(3), 0.0
    for j in range(height):
        for i in range(width):
            pixel, weight = image[top + j, left + i], weights[top + j, left + i]
            T[0] = down[j] * across[i]
            T[1] = -flux * down[j] * across_slope[i]
            T[2] = -flux * down_slope[j] * across[i]
            rest = pixel - flux * T[0]
            gain += weight * (pixel * pixel - rest * rest)
            for a in range(3):
                weighted = weight * T[a]
                score[a] += weighted * rest
                for b in range(3):
                    information[a, b] += weighted * T[b]
    return gain


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
    side = 2 * reach + 1
    for m in range(len(flux)):
        u, v = uv_px[m, 0] - corner_px[0], uv_px[m, 1] - corner_px[1]
        if not math.isfinite(u + v):
            continue
        left, top = int(np.rint(u)) - reach, int(np.rint(v)) - reach
        if left < 0 or top < 0 or left + side > width or top + side > height:
            continue
        patch, own, pull = (left, top, side, side), information[m], score[m]
        gain += add_fit(images[m], weights[m], patch, u, v, flux[m], box_px, sigma_px, own, pull)
    return information, score, gain


@compiled
def centre_fit(
    image: Array, weights: Array, u_px: float, v_px: float, box_px: float, sigma_px: float
) -> tuple[float, float, float, Array, bool]:
    """Most likely centre (u, v) and flux of a marker near a peak in an image (h, w), their information (3, 3)
    as (flux, column, row), and whether there is light that stays near the peak."""
    patch = (0, 0, image.shape[1], image.shape[0])
    u, v, flux, F = u_px, v_px, 0.0, np.zeros((3, 3))
    for _ in range(_FIT_STEPS):
        F, step = np.zeros((3, 3)), np.zeros(3)
        add_fit(image, weights, patch, u, v, 0.0, box_px, sigma_px, F, step)
        flux = step[0] / F[0, 0]
        F, step = np.zeros((3, 3)), np.zeros(3)
        add_fit(image, weights, patch, u, v, flux, box_px, sigma_px, F, step)
        L = F.copy()
        factor(L)
        solve(L, step)
        du = min(max(step[1], -_MAX_STEP_PX), _MAX_STEP_PX)
        dv = min(max(step[2], -_MAX_STEP_PX), _MAX_STEP_PX)
        u, v = u + du, v + dv
        if not (flux > 0 and math.hypot(u - u_px, v - v_px) <= _MAX_WANDER_PX):
            return u, v, flux, F, False
        if max(abs(du), abs(dv)) < _CONVERGED_PX:
            break
    return u, v, flux, F, True


@compiled
def normal_equations_with_light(
    J: Array, light_by_flux: Array, information: Array, score: Array
) -> tuple[Array, Array]:
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
