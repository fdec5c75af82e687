"""Noise of a synthetic sensor in machine code: trials of long sequences spend most of their time on it."""

from __future__ import annotations

import math

import numpy as np

from perception.kernels.compiled import compiled


@compiled
def with_noise(
    rng: np.random.Generator, expected_e: np.ndarray, read_e: float, gain_e: float, full_counts: float
) -> np.ndarray:
    """Frames (n, h, w) of uint16 [counts] that a sensor shows of expected electrons (n, h, w).

    Shot noise as a Gaussian, read noise, rounding, clipping at full well. Handing over a generator costs as
    much as 5000 pixels, so better many frames at once.
    """
    counts = np.empty(expected_e.shape, dtype=np.uint16)
    frames, height, width = counts.shape
    for k in range(frames):
        for v in range(height):
            for u in range(width):
                light = expected_e[k, v, u]
                noisy = light + math.sqrt(light + read_e * read_e) * rng.standard_normal()
                counts[k, v, u] = min(max(np.rint(noisy / gain_e), 0.0), full_counts)
    return counts
