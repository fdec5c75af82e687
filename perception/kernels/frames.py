"""Loops over all pixels of all frames, in few passes through memory (perception.frames.similarity)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perception.kernels.compiled import compiled

Counts = NDArray[np.uint16]
Frames = NDArray[np.float32]

_BLOCK = 4096  # pixels that stay in the cache while all frames are gone through


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
    dots, squares = np.zeros((n, 4), dtype=np.float32), np.zeros(n, dtype=np.float32)
    frames, off = np.empty((n, pixels), dtype=np.float32), np.empty(_BLOCK, dtype=np.float32)
    for start in range(0, pixels, _BLOCK):
        block = slice(start, min(start + _BLOCK, pixels))
        usual = middle[block]
        for k in range(n):
            frame = flat[k, block]
            for p in range(len(usual)):
                off[p] = np.float32(frame[p]) - usual[p]
            for i in range(4):
                dots[k, i] += np.dot(by[i, block], off[: len(usual)])
    coefficients = dots @ inverse.T
    columns = basis.reshape((4, pixels))
    for start in range(0, pixels, _BLOCK):
        block = slice(start, min(start + _BLOCK, pixels))
        usual = middle[block]
        along_u, along_v, contrast, one = (
            columns[0, block],
            columns[1, block],
            columns[2, block],
            columns[3, block],
        )
        for k in range(n):
            a, b, c, d = coefficients[k]
            frame, freed = flat[k, block], frames[k, block]
            for p in range(len(usual)):
                fit = a * along_u[p] + b * along_v[p] + c * contrast[p] + d * one[p]
                left = np.float32(frame[p]) - usual[p] - fit
                freed[p] = left + usual[p]
                off[p] = min(max(left, -bound), bound)
            squares[k] += np.dot(off[: len(usual)], off[: len(usual)])
    rest = np.sqrt(squares / np.float32(pixels))
    return coefficients, rest, frames.reshape(stack.shape)
