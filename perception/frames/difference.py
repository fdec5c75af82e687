"""Difference image analysis (DIA): one difference image per marker from an on/off sequence (paper, 4.1).

A sequence is: reference, one image per marker, and again N times, closed by a reference. Each marker's
frame is compared with the two references that bracket it, weighted by nearness in time, so a steady drift
of the light cancels; N such differences are averaged.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array

_LEAK_FACTOR = 1.15
_NO_WORD = 1e6  # counts, of noise: a pixel that says nothing
_MARKER_SIGMAS = 4.0  # of the background: what lies beyond is a marker or a hot pixel
_SPREAD_ROUNDS = 2
_ROUNDING = 1e-3  # counts, of single precision: an even image is not all outliers


@dataclass(frozen=True, eq=False)
class Difference:
    """Difference images (markers, h, w) [counts] and their standard deviations (markers, h, w) [counts].

    `reference` (h, w) is the mean image with all markers dark. `pairs` counts on-frames per marker.
    """

    images: NDArray[np.float32]
    sigma: NDArray[np.float32]
    reference: NDArray[np.float32]
    pairs: int

    def without(self, pixels: NDArray[np.bool_]) -> Difference:
        """The same with nothing said in some pixels (h, w)."""
        if not pixels.any():
            return self
        images, sigma = self.images.copy(), self.sigma.copy()
        images[:, pixels], sigma[:, pixels] = 0.0, _NO_WORD
        return replace(self, images=images, sigma=sigma)


def led_sequence(markers: int, pairs: int, skip: frozenset[int] = frozenset()) -> tuple[int, ...]:
    """LED masks of a shot: reference, each marker alone, `pairs` times over, closed by a reference."""
    if pairs < 1 or markers < 1:
        raise ValueError(f"got {markers} markers and {pairs} pairs, expected at least 1 of each")
    cycle = (0, *(1 << m for m in range(markers) if m not in skip))
    return cycle * pairs + (0,)


def pair_weights(leds: Sequence[int], markers: int) -> Array:
    """Weights (markers, frames) that turn a stack into difference images; a marker never lit has zeros.

    Raises ValueError without a dark frame or with two markers lit at once.
    """
    dark = [i for i, mask in enumerate(leds) if mask == 0]
    if not dark:
        raise ValueError("got a sequence without a dark frame, expected at least one")
    W = np.zeros((markers, len(leds)))
    for i, mask in enumerate(leds):
        if mask == 0:
            continue
        marker = mask.bit_length() - 1
        if mask != 1 << marker or marker >= markers:
            raise ValueError(f"frame {i}: got LED mask {mask:#b}, expected one of {markers} markers alone")
        W[marker, i] += 1.0
        for j, share in _bracket(i, dark):
            W[marker, j] -= share
    on = np.array([sum(mask == 1 << m for mask in leds) for m in range(markers)])
    weights: Array = W / np.maximum(on, 1)[:, None]
    return weights


def _bracket(i: int, dark: list[int]) -> list[tuple[int, float]]:
    """The dark frames next to frame i, with shares that interpolate in time."""
    before = max((j for j in dark if j < i), default=None)
    after = min((j for j in dark if j > i), default=None)
    if before is None or after is None:
        return [(before if before is not None else dark[0], 1.0)]
    share = (i - before) / (after - before)
    return [(before, 1.0 - share), (after, share)]


def difference(
    frames: NDArray[np.float32], leds: Sequence[int], markers: int, noise_counts: float
) -> Difference:
    """Difference images of a stack (frames, h, w) [counts].

    The noise of one frame comes from the dark frames, which no marker touches; that of a difference image
    follows from its weights, unless the image itself is noisier (texture that leaked in). Within an image
    the variance goes with the brightness (shot noise). `noise_counts`, the calibrated noise, bounds it from
    below, as a clipped or empty window shows none.
    """
    if frames.ndim != 3 or len(frames) != len(leds):
        raise ValueError(f"frames: got shape {frames.shape}, expected ({len(leds)}, height, width)")
    W = pair_weights(leds, markers)
    flat = frames.reshape(len(frames), -1)
    images = (W.astype(np.float32) @ flat).reshape(markers, *frames.shape[1:])
    reference = frames[[mask == 0 for mask in leds]].mean(axis=0)
    relative = relative_noise(reference)
    frame_noise = max(_frame_noise(frames, leds, relative), 0.3 * noise_counts)
    expected = frame_noise * np.linalg.norm(W, axis=1)
    scale = [shown_noise(image / relative, float(e)) for image, e in zip(images, expected, strict=True)]
    sigma = np.array(scale, dtype=np.float32)[:, None, None] * relative
    pairs = min((leds.count(1 << m) for m in range(markers) if 1 << m in leds), default=0)
    return Difference(images, sigma.astype(np.float32), reference, pairs)


def _frame_noise(frames: NDArray[np.float32], leds: Sequence[int], relative: NDArray[np.float32]) -> float:
    """Standard deviation of one frame's pixel from first and last dark frame [counts], 0 with only one."""
    dark = [i for i, mask in enumerate(leds) if mask == 0]
    if len(dark) < 2:
        return 0.0
    return _spread((frames[dark[0]] - frames[dark[-1]]) / relative) / math.sqrt(2.0)


def relative_noise(reference: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """Noise of each pixel of a window relative to its mean: shot noise goes with the root of brightness."""
    bright = np.clip(reference / max(float(reference.mean()), 1.0), 0.2, 4.0)
    return np.asarray(np.sqrt(bright), dtype=np.float32)


def shown_noise(image: NDArray[np.floating[Any]], expected: float) -> float:
    """The expected noise of a difference image, or what it shows where that is clearly more [counts]."""
    shown = _spread(image)
    return shown if shown > _LEAK_FACTOR * expected else max(expected, 1e-6)


def _spread(image: NDArray[np.floating[Any]]) -> float:
    """Standard deviation of the background.

    Not from quantiles: counts are whole numbers, a quantile of their difference is off by up to half of one.
    """
    pixels = np.asarray(image - image.mean(), dtype=np.float32).ravel()
    variance, limit = 0.0, math.inf
    for _ in range(_SPREAD_ROUNDS + 1):
        within = np.abs(pixels) <= limit
        pixels, count = pixels * within, int(np.count_nonzero(within))
        variance = float(pixels @ pixels) / max(count, 1) - (float(pixels.sum()) / max(count, 1)) ** 2
        limit = _MARKER_SIGMAS * math.sqrt(max(variance, 0.0)) + _ROUNDING
    return math.sqrt(max(variance, 0.0))
