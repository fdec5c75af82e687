"""Noise of a synthetic sensor in machine code: trials of long sequences spend most of their time on it."""

from __future__ import annotations

import math

import numpy as np

from perception.kernels.compiled import compiled


@compiled
def add_noise(
    rng: np.random.Generator,
    expected_e: np.ndarray,
    read_e: float,
    gain_e: float,
    full_counts: float,
    counts: np.ndarray,
) -> None:
    """Fill a frame (h, w) of uint16 [counts] with what a sensor shows of expected electrons (h, w).

    Shot noise as a Gaussian, read noise, rounding, clipping at full well.
    """
    height, width = counts.shape
    for v in range(height):
        for u in range(width):
            light = expected_e[v, u]
            noisy = light + math.sqrt(light + read_e * read_e) * rng.standard_normal()
            counts[v, u] = min(max(np.rint(noisy / gain_e), 0.0), full_counts)
