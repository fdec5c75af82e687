"""Stacking of a coded sequence: frames stream through, only sums per LED stay.

Each block of frames is registered and re-exposed onto its own mean (perception.similarity) and then split by
least squares into what each LED adds to the ground. A block forgets its mean, so whatever changes from block
to block - light, shadows, the head - takes no part. Memory is that of a block, however long the sequence.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from executive.types import Array
from perception.codes import lit
from perception.difference import Difference, relative_noise, shown_noise
from perception.similarity import compare

BLOCK_FRAMES = 64
_FITTED_PER_FRAME = 4  # shift along u and v, contrast, brightness


class Stack:
    """Sums over the frames of one camera's window, from which difference images follow at any time."""

    def __init__(self, markers: int, noise_counts: float) -> None:
        self._noise_counts = noise_counts
        self._gram: Array = np.zeros((markers, markers))
        self._sums: Array | None = None
        self._ground: Array | None = None
        self._rest = 0.0
        self._frames = self._free = 0
        self._on = np.zeros(markers)
        self.problem = ""

    def add(self, counts: NDArray[np.uint16], leds: tuple[int, ...]) -> None:
        """Take in frames (n, h, w) [counts] exposed with these LED masks; ValueError on other shapes."""
        if counts.ndim != 3 or len(counts) != len(leds):
            raise ValueError(f"counts: got shape {counts.shape}, expected ({len(leds)}, height, width)")
        blocks = max(1, round(len(leds) / BLOCK_FRAMES))
        edges = np.linspace(0, len(leds), blocks + 1).astype(int)
        for first, last in itertools.pairwise(edges):
            self._add_block(counts[first:last], leds[first:last])

    def _add_block(self, counts: NDArray[np.uint16], leds: tuple[int, ...]) -> None:
        similar = compare(counts, self._noise_counts)
        self.problem = self.problem or similar.problem
        on = lit(leds, len(self._on))
        code = on - on.mean(axis=0)
        flat = similar.frames.reshape(len(leds), -1)
        shape = (len(self._on), *counts.shape[1:])
        sums = (code.T.astype(np.float32) @ flat).reshape(shape).astype(np.float64)
        ground = similar.frames.mean(axis=0).astype(np.float64) * len(leds)
        self._gram = self._gram + code.T @ code
        self._sums = sums if self._sums is None else self._sums + sums
        self._ground = ground if self._ground is None else self._ground + ground
        self._rest += float((similar.rest_counts**2).sum())
        self._frames += len(leds)
        self._free += len(leds) - 1
        self._on += on.sum(axis=0)

    @property
    def pairs(self) -> int:
        """On/off pairs taken in so far, of the LED that has the fewest."""
        return int(min(self._on.min(), (self._frames - self._on).min()))

    def difference(self) -> Difference:
        """Difference images of all LEDs with their noise; ValueError before the first frames.

        An LED that was never switched has an image of zeros and infinite noise.
        """
        if self._sums is None or self._ground is None:
            raise ValueError("got no frames yet, expected some")
        inverse = np.linalg.pinv(self._gram, rcond=1e-6)
        images = np.einsum("mk,khw->mhw", inverse, self._sums)
        ground = self._ground / self._frames
        reference = ground - np.einsum("m,mhw->hw", self._on / self._frames, images)
        relative = relative_noise(reference)
        explained = float(np.einsum("mhw,mhw->", images, self._sums)) / ground.size
        sigma = np.full(len(images), np.inf)
        for m, variance in enumerate(np.diag(inverse)):
            if variance > 0:
                sigma[m] = shown_noise(
                    images[m] / relative, self._frame_noise(explained) * math.sqrt(variance)
                )
        return Difference(
            images.astype(np.float32),
            (sigma[:, None, None] * relative).astype(np.float32),
            reference.astype(np.float32),
            self.pairs,
        )

    def _frame_noise(self, explained: float) -> float:
        """Standard deviation of one frame's pixel [counts], from what neither scene nor LEDs explain."""
        pixels = 1 if self._sums is None else self._sums[0].size
        free = max(self._free - np.linalg.matrix_rank(self._gram), 1) * (1 - _FITTED_PER_FRAME / pixels)
        return math.sqrt(max((self._rest - explained) / free, (0.3 * self._noise_counts) ** 2))
