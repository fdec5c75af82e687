"""Sums of shifted filter images, the scores of a pattern of markers at all places near its own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from perception.kernels.compiled import compiled


@compiled
def best_shifts(
    snr: tuple[NDArray[np.float32], NDArray[np.float32]],
    corners_px: NDArray[np.int64],
    used: NDArray[np.bool_],
    uv_px: Array,
    rows: int,
    columns: int,
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """The highest sum of each pattern (p, 2, n, 2), shifted by up to so many rows and columns, over both
    cameras and the used markers (n,), and the row and column (p, 2) by which it is shifted there."""
    patterns = len(uv_px)
    highest, shift = np.empty(patterns, dtype=np.float32), np.empty((patterns, 2), dtype=np.int64)
    total = np.empty((2 * rows + 1, 2 * columns + 1), dtype=np.float32)
    for p in range(patterns):
        total[:] = 0
        for c in range(2):
            add_pattern(total, snr[c], corners_px[c, 0], corners_px[c, 1], uv_px[p, c], used)
        at = int(total.argmax())
        j, i = at // total.shape[1], at % total.shape[1]
        highest[p], shift[p, 0], shift[p, 1] = total[j, i], j - rows, i - columns
    return highest, shift


@compiled
def add_pattern(
    total: NDArray[np.float32],
    snr: NDArray[np.float32],
    left: int,
    top: int,
    uv_px: Array,
    used: NDArray[np.bool_],
) -> None:
    """Add to scores (2 r + 1, 2 c + 1) the images (n, h, w) of used markers at pixels (n, 2), shifted by up
    to r rows and c columns; what lies outside an image, whose corner is at (left, top), adds nothing."""
    rows, columns = total.shape
    height, width = snr.shape[1:]
    for m in range(len(snr)):
        if not used[m]:
            continue
        u = int(np.rint(uv_px[m, 0])) - left - columns // 2
        v = int(np.rint(uv_px[m, 1])) - top - rows // 2
        first, last = max(-u, 0), min(columns, width - u)
        if first >= last:  # slices would count from the other end
            continue
        for j in range(max(-v, 0), min(rows, height - v)):
            sums, light = total[j, first:last], snr[m, v + j, u + first : u + last]
            for i in range(len(light)):
                sums[i] += light[i]
