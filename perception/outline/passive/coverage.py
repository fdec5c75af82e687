"""Exact shares of pixels that polygons cover: edges are cut at pixel borders and their areas summed.

A polygon's share is the integral of its outline to the left of each pixel (Green's theorem), so it changes
smoothly as the polygon moves, which is what derivatives of a picture need.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array

Layers = NDArray[np.float32]


def coverage(start: Array, end: Array, layer: NDArray[np.intp], shape: tuple[int, int, int]) -> Layers:
    """Covered shares (layers, h, w) of outlines made of directed segments `start` to `end`, (n, 2) each.

    Coordinates (x, y) run over [0, w] x [0, h], whole numbers are pixel borders; what lies outside is cut
    off. Outlines of one layer must close and wind alike and must not overlap; winding either way counts as 1.
    """
    layers, height, width = shape
    a, b, owner = _pieces(start, end)
    row = np.floor((a[:, 1] + b[:, 1]) / 2).astype(np.intp)
    inside = (row >= 0) & (row < height)
    a, b, row, where = a[inside], b[inside], row[inside], layer[owner[inside]]
    drop = b[:, 1] - a[:, 1]
    x = np.clip((a[:, 0] + b[:, 0]) / 2, 0, width)
    column = np.minimum(x.astype(np.intp), width)
    right = drop * (x - column)
    stride = width + 2
    at = (where * height + row) * stride + column
    size = layers * height * stride
    flat = np.bincount(at, drop - right, size) + np.bincount(at + 1, right, size)
    shares = np.cumsum(flat.reshape(layers, height, stride).astype(np.float32), axis=2)[:, :, :width]
    return np.abs(shares)


def _pieces(start: Array, end: Array) -> tuple[Array, Array, NDArray[np.intp]]:
    """The segments cut at every whole x and y: pieces from (n, 2) to (n, 2), and whose they are."""
    owners, cuts = [], []
    for axis in (0, 1):
        low, high = np.minimum(start[:, axis], end[:, axis]), np.maximum(start[:, axis], end[:, axis])
        first = np.floor(low) + 1
        count = np.maximum(np.ceil(high) - first, 0).astype(np.intp)
        owner = np.repeat(np.arange(len(start)), count)
        nth = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
        border = first[owner] + nth
        cuts.append((border - start[owner, axis]) / (end - start)[owner, axis])
        owners.append(owner)
    every = np.arange(len(start))
    owner = np.concatenate([every, *owners, every])
    share = np.concatenate([np.zeros(len(start)), *cuts, np.ones(len(start))])
    order = np.lexsort((share, owner))
    owner, share = owner[order], share[order]
    point = start[owner] + share[:, None] * (end - start)[owner]
    same = owner[1:] == owner[:-1]
    return point[:-1][same], point[1:][same], owner[:-1][same]
