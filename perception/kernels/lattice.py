"""Sums of shifted filter images, the scores of a pattern of markers at all places near its own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from executive.types import Array
from perception.kernels.compiled import compiled


@compiled
def add_pattern(
    total: NDArray[np.float32], snr: NDArray[np.float32], left: int, top: int, uv_px: Array
) -> None:
    """Add to scores (2 r + 1, 2 c + 1) the images (n, h, w) of markers at pixels (n, 2), shifted by up to r
    rows and c columns; what lies outside an image, whose corner is at (left, top), adds nothing."""
    rows, columns = total.shape
    height, width = snr.shape[1:]
    for m in range(len(snr)):
        u = int(np.rint(uv_px[m, 0])) - left - columns // 2
        v = int(np.rint(uv_px[m, 1])) - top - rows // 2
        first, last = max(-u, 0), min(columns, width - u)
        for j in range(max(-v, 0), min(rows, height - v)):
            for i in range(first, last):
                total[j, i] += snr[m, v + j, u + i]
