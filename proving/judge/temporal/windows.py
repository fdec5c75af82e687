"""The least of a sequence over many windows at once, in O(n log w) and without a loop over samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array

Indices = NDArray[np.int64]


def least(values: Array, first: Indices, last: Indices) -> Array:
    """Minimum of `values[first[i] : last[i] + 1]` for each i; inf for an empty window, NaN left out.

    NaN only where a window holds nothing else. Windows are covered by two spans of a power of two each,
    which may overlap: that does not change a minimum. All shapes (n,).
    """
    lengths = last - first + 1
    found = np.full(len(first), np.inf)
    longest = int(lengths.max(initial=0))
    spans, width = values, 1  # spans[i] is the least of the `width` values from i on
    while width <= longest:
        mine = (lengths >= width) & (lengths < 2 * width)
        found[mine] = np.fmin(spans[first[mine]], spans[last[mine] - width + 1])
        spans, width = np.fmin(spans[:-width], spans[width:]), 2 * width
    return found


def covered(asked: NDArray[np.bool_], first: Indices, last: Indices) -> NDArray[np.bool_]:
    """Which samples lie in the window of any sample that is asked for, shape (n,)."""
    mine = asked & (last >= first)
    change = np.zeros(len(asked) + 1, dtype=np.int64)
    np.add.at(change, first[mine], 1)
    np.add.at(change, last[mine] + 1, -1)
    return np.cumsum(change)[:-1] > 0
