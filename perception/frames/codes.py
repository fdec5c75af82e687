"""Coded LED sequences: all LEDs at work at once, told apart by orthogonal codes.

Each LED is on in half of the frames, so a sequence of 2 N frames holds N on/off pairs of every LED at the
noise that N pairs of one LED alone would have. The codes are the Walsh functions with the most changes of
sign: what changes slowly over the sequence (light, shadows, a drifting head) looks like none of them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import hadamard

from executive.core.types import Array


def coded_sequence(markers: int, pairs: int) -> tuple[int, ...]:
    """LED masks of 2 `pairs` frames; ValueError with fewer pairs than would tell the markers apart."""
    codes = walsh_codes(markers)
    least = codes.shape[1] // 2
    if pairs < least:
        raise ValueError(f"got {pairs} pairs for {markers} markers, expected {least} or more")
    frames = np.resize(np.arange(codes.shape[1]), 2 * pairs)
    bits = (codes[:, frames] > 0) * (1 << np.arange(markers))[:, None]
    return tuple(bits.sum(axis=0).tolist())


def walsh_codes(markers: int) -> NDArray[np.int_]:
    """The `markers` Walsh functions of highest sequency (markers, order), +1 and -1, balanced, orthogonal.

    The order is the least power of two of which these are the upper half.
    """
    if markers < 1:
        raise ValueError(f"got {markers} markers, expected 1 or more")
    order = 2 << (markers - 1).bit_length()
    rows: NDArray[np.int_] = hadamard(order).astype(int)
    sequency = np.count_nonzero(np.diff(rows, axis=1), axis=1)
    return rows[np.argsort(-sequency)[:markers]]


def lit(leds: tuple[int, ...], markers: int) -> Array:
    """1 where a marker is on in a frame, else 0, shape (frames, markers)."""
    on: Array = (np.array(leds)[:, None] >> np.arange(markers) & 1).astype(np.float64)
    return on


def is_coded(leds: tuple[int, ...]) -> bool:
    """Whether several LEDs are ever on together."""
    return any(mask & (mask - 1) for mask in leds)
