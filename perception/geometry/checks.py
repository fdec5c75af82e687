"""Checks of arrays at the boundary: wrong input is refused in words, never computed with."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from executive.core.types import Array


def as_array(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Array:
    """`values` as float64 of `shape` (None matches any length of 1 or more); ValueError otherwise."""
    array = np.asarray(values, dtype=np.float64)
    fits = array.ndim == len(shape) and all(
        n > 0 and (want is None or n == want) for n, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        expected = tuple("n" if want is None else want for want in shape)
        raise ValueError(f"{name}: got shape {array.shape}, expected ({', '.join(map(str, expected))})")
    return array


def as_finite(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Array:
    """Like `as_array`, and ValueError where a value is NaN or infinite."""
    array = as_array(name, values, shape)
    if not np.isfinite(array).all():
        raise ValueError(
            f"{name}: got {np.count_nonzero(~np.isfinite(array))} non-finite values, expected none"
        )
    return array
