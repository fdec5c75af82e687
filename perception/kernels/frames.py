"""Loops over all pixels of all frames, in few passes through memory (perception.similarity)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perception.kernels.compiled import compiled

Counts = NDArray[np.uint16]
Frames = NDArray[np.float32]


@compiled
def mean_and_range(stack: Counts) -> tuple[Frames, Counts]:
    """Mean (h, w) of frames (n, h, w), and by how much each pixel varies."""
    n, height, width = stack.shape
    total = np.zeros((height, width), dtype=np.int64)
    low, high = stack[0].copy(), stack[0].copy()
    for k in range(n):
        for v in range(height):
            for u in range(width):
                count = stack[k, v, u]
                total[v, u] += count
                low[v, u] = min(low[v, u], count)
                high[v, u] = max(high[v, u], count)
    mean = np.empty((height, width), dtype=np.float32)
    for v in range(height):
        for u in range(width):
            mean[v, u] = total[v, u] / n
    return mean, high - low


@compiled
def equalised(
    stack: Counts | Frames, mean: Frames, basis: Frames, weighted: Frames, inverse: Frames, limit: float
) -> tuple[Frames, Frames, Frames]:
    """Coefficients (n, 4) of the basis (4, h, w) in each frame's difference from the mean, the rest (n,), in
    which `limit` is the most a pixel counts, and the frames (n, h, w) freed of them.

    `weighted` is the basis on the pixels that count, `inverse` (4, 4) that of its Gram matrix. Single
    precision, whose loops take half the time.
    """
    n, height, width = stack.shape
    pixels, bound = height * width, np.float32(limit)
    flat, middle, by = stack.reshape((n, pixels)), mean.reshape(pixels), weighted.reshape((4, pixels))
    along_u, along_v, contrast, one = basis.reshape((4, pixels))
    coefficients, rest = np.empty((n, 4), dtype=np.float32), np.empty(n, dtype=np.float32)
    frames, off = np.empty((n, pixels), dtype=np.float32), np.empty(pixels, dtype=np.float32)
    for k in range(n):
        for p in range(pixels):
            off[p] = np.float32(flat[k, p]) - middle[p]
        coefficients[k] = inverse @ (by @ off)
        a, b, c, d = coefficients[k]
        for p in range(pixels):
            left = off[p] - a * along_u[p] - b * along_v[p] - c * contrast[p] - d * one[p]
            frames[k, p] = left + middle[p]
            off[p] = min(max(left, -bound), bound)
        rest[k] = math.sqrt(np.dot(off, off) / np.float32(pixels))
    return coefficients, rest, frames.reshape(stack.shape)
