"""Stacking of a coded sequence: frames stream through, only sums per LED stay.

Each block of frames is registered and re-exposed onto its own mean (frames.similarity) and then split by
least squares into what each LED adds to the ground. A block forgets its mean, so whatever changes from block
to block - light, shadows, the head - takes no part. Memory is that of a block, however long the sequence.
Pixels that never change, or change more than the others, have as little say as that makes them worth.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from perception.frames.codes import lit
from perception.frames.difference import Difference, relative_noise, shown_noise
from perception.frames.shots import fresh, staleness
from perception.frames.similarity import compare

BLOCK_FRAMES = 64
_FITTED_PER_FRAME = 4  # shift along u and v, contrast, brightness
_CALM_SIGMAS = 6.0  # a pixel whose variance is above the others' by more of its own scatter is a restless one
_ONE_COUNT = 0.5  # noise from which on a pixel that never changes is no pixel of the scene


class Stack:
    """Sums over the frames of one camera's window, from which difference images follow at any time."""

    def __init__(self, markers: int, noise_counts: float) -> None:
        self._noise_counts = noise_counts
        self._gram: Array = np.zeros((markers, markers))
        self._sums: Array | None = None
        self._ground: Array | None = None
        self._squares: Array | None = None
        self._still: NDArray[np.bool_] | None = None
        self._rest = 0.0
        self._frames = self._free = 0
        self._on = np.zeros(markers)
        self._unknown_px2 = 0.0
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
        kept = fresh(counts)
        if stale := staleness(kept):
            self.problem = self.problem or stale
            return
        if not kept.all():
            counts, leds = counts[kept], tuple(mask for mask, keep in zip(leds, kept, strict=True) if keep)
        similar = compare(counts, self._noise_counts)
        self.problem = self.problem or similar.problem
        on = lit(leds, len(self._on))
        code = on - on.mean(axis=0)
        mean = similar.frames.mean(axis=0)
        flat = (similar.frames - mean).reshape(len(leds), -1)
        sums = (code.T.astype(np.float32) @ flat).reshape(len(self._on), *mean.shape)
        squares = np.einsum("kp,kp->p", flat, flat).reshape(mean.shape)
        still = counts.max(axis=0) == counts.min(axis=0)
        self._gram = self._gram + code.T @ code
        self._sums = _plus(self._sums, sums)
        self._ground = _plus(self._ground, mean * len(leds))
        self._squares = _plus(self._squares, squares)
        self._still = still if self._still is None else self._still & still
        self._rest += float((similar.rest_counts**2).sum())
        self._frames += len(leds)
        self._free += len(leds) - 1
        self._unknown_px2 += (similar.unknown_px * len(leds)) ** 2
        self._on += on.sum(axis=0)

    @property
    def pairs(self) -> int:
        """On/off pairs taken in so far, of the LED that has the fewest."""
        return int(min(self._on.min(), (self._frames - self._on).min()))

    @property
    def unknown_px(self) -> float:
        """How little is known of where a head that vibrated pointed on average (frames.vibration)."""
        return math.sqrt(self._unknown_px2) / max(self._frames, 1)

    @property
    def reference(self) -> NDArray[np.float32]:
        """The mean image so far (h, w) [counts]; a black pixel before the first frames."""
        if self._ground is None:
            return np.zeros((1, 1), np.float32)
        return (self._ground / self._frames).astype(np.float32)

    def difference(self) -> Difference:
        """Difference images of all LEDs with their noise; ValueError before the first frames.

        An LED that was never switched has an image of zeros and infinite noise.
        """
        if self._sums is None or self._ground is None or self._squares is None or self._still is None:
            raise ValueError("got no frames yet, expected some")
        inverse = np.linalg.pinv(self._gram, rcond=1e-6)
        images = np.einsum("mk,khw->mhw", inverse, self._sums)
        ground = self._ground / self._frames
        reference = ground - np.einsum("m,mhw->hw", self._on / self._frames, images)
        relative = relative_noise(reference)
        explained = np.einsum("mhw,mhw->hw", images, self._sums)
        noise = self._frame_noise(float(explained.mean()))
        unrest = _unrest((self._squares - explained) / (noise * relative) ** 2, self._degrees_free)
        sigma = np.full(len(images), np.inf)
        for m, variance in enumerate(np.diag(inverse)):
            if variance > 0:
                sigma[m] = shown_noise(images[m] / (relative * unrest), noise * math.sqrt(variance))
        whole = Difference(
            images.astype(np.float32),
            (sigma[:, None, None] * relative * unrest).astype(np.float32),
            reference.astype(np.float32),
            self.pairs,
        )
        return whole.without(self._still) if noise > _ONE_COUNT else whole

    @property
    def _degrees_free(self) -> int:
        """Frames less what was fitted to each pixel."""
        return max(self._free - int(np.linalg.matrix_rank(self._gram)), 1)

    def _frame_noise(self, explained: float) -> float:
        """Standard deviation of one frame's pixel [counts], from what neither scene nor LEDs explain."""
        pixels = 1 if self._sums is None else self._sums[0].size
        free = self._degrees_free * (1 - _FITTED_PER_FRAME / pixels)
        return math.sqrt(max((self._rest - explained) / free, (0.3 * self._noise_counts) ** 2))


def _plus(total: Array | None, more: NDArray[np.float32]) -> Array:
    return more.astype(np.float64) if total is None else total + more


def _unrest(chi2: Array, free: int) -> Array:
    """By how much each pixel (h, w) is noisier than it should be, from its sum of squares; 1 where chance
    may do as much. Flickering pixels are, and what a shadow's edge goes over."""
    ratio = np.maximum(chi2, 0.0) / free
    return np.sqrt(np.where(ratio > 1 + _CALM_SIGMAS * math.sqrt(2 / free), ratio, 1.0))
