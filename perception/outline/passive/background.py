"""The empty view laid under the view of the rover: shifted, re-exposed, with what then still differs.

The head comes back to a pointing only as well as its axes do, by up to a pixel. What the rover and its shadow
cover is an outlier here; the fit weighs it down.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array

_SEARCH_PX = 4
_SPARSE = 3  # of pixels that choose the whole-pixel shift
_STEPS = 8
_OUTLIER = 3.0  # spreads from which a pixel counts for another thing than ground
_MAD = 1.4826
_LEAST_GROUND = 0.5  # share of the view that must be ground as seen before
_LEAST_EXPLAINED = 0.1  # of the ground's texture, by variance
_MOST_LIGHT = 5.0  # and least: a view five times as bright or as dark is one of a lamp, or of nothing
_PLAIN = 2.5  # noises of texture below which there is nothing to recognise
_SHIFT_NOISE_PX = 0.03


@dataclass(frozen=True, eq=False)
class Background:
    """`counts` (h, w) is the empty view as it would be now; `sigma` (h, w) how well that is known [counts].

    `shift_px` (2,) and `gain` are what was taken out; `explained` the share of the ground's variance that the
    view shares with the empty one; `problem` says why the two do not fit, or is empty.
    """

    counts: Array
    sigma: Array
    shift_px: Array
    gain: float
    explained: float
    problem: str


def lay_under(image: Array, empty: Array, noise: float) -> Background:
    """Fit the empty view (h, w) to an image (h, w) [counts], whose pixels have this noise."""
    moved = _coarse_shift(image, empty)
    gain, offset = 1.0, 0.0
    for _ in range(_STEPS):
        laid = _shifted(empty, moved)
        along_v, along_u = np.gradient(laid)
        rest = image - (gain * laid + offset)
        weight = _ground(rest)
        A = np.stack([gain * along_u, gain * along_v, laid - laid.mean(), np.ones_like(laid)])[:, weight]
        change = np.linalg.lstsq(A.T, rest[weight], rcond=None)[0]
        moved = moved - change[:2]
        gain += float(change[2])
        offset += float(change[3]) - float(change[2]) * float(laid.mean())
        if np.abs(change[:2]).max() < 1e-3:
            break
    laid = gain * _shifted(empty, moved) + offset
    return _judged(image, laid, moved, gain, noise)


def _judged(image: Array, laid: Array, moved: Array, gain: float, noise: float) -> Background:
    rest = image - laid
    spread = _spread(rest)
    ground = np.abs(rest) < _OUTLIER * spread
    texture = float(_flattened(image)[ground].std())
    unexplained = float(_flattened(rest)[ground].std())
    explained = 1 - (unexplained / max(texture, 1e-9)) ** 2
    slope = np.hypot(*np.gradient(laid))
    sigma = np.hypot(max(spread, noise), _SHIFT_NOISE_PX * slope)
    problem = ""
    if texture > _PLAIN * noise and explained < _LEAST_EXPLAINED:
        problem = f"the background explains {explained:.0%} of the ground seen, {_LEAST_EXPLAINED:.0%} needed"
    elif not 1 / _MOST_LIGHT <= gain <= _MOST_LIGHT:
        problem = f"the ground shows {gain:.2f} times the contrast that it had"
    return Background(laid, sigma, moved, gain, explained, problem)


def _flattened(image: Array) -> Array:
    """Without what changes slowly, and without grain that a part of a pixel's shift makes anew."""
    fine, coarse = (cv2.GaussianBlur(image, (0, 0), sigma) for sigma in (1.0, 8.0))
    return np.asarray(fine - coarse, dtype=np.float64)


def _spread(rest: Array) -> float:
    return float(_MAD * np.median(np.abs(rest - np.median(rest)))) + 1e-9


def _ground(rest: Array) -> NDArray[np.bool_]:
    """Pixels that differ no more than most do."""
    limit = np.quantile(np.abs(rest), _LEAST_GROUND)
    return np.asarray(np.abs(rest) <= _OUTLIER * _MAD * limit)


def _coarse_shift(image: Array, empty: Array) -> Array:
    """The whole-pixel shift at which most of the views agree."""
    r = _SEARCH_PX
    core = _flattened(image)[r:-r:_SPARSE, r:-r:_SPARSE]
    flat = _flattened(empty)
    limit = 2 * float(np.median(np.abs(core)))
    best, found = np.inf, np.zeros(2)
    h, w = image.shape[0] - 2 * r, image.shape[1] - 2 * r
    for dv in range(-r, r + 1):
        for du in range(-r, r + 1):
            part = flat[r - dv : r - dv + h : _SPARSE, r - du : r - du + w : _SPARSE]
            off = float(np.mean(np.minimum(np.abs(core - part), limit)))
            if off < best:
                best, found = off, np.array([du, dv], dtype=np.float64)
    return found


def _shifted(image: Array, by_px: Array) -> Array:
    """The image moved by (right, down) pixels, cubic between pixels."""
    move = np.array([[1, 0, by_px[0]], [0, 1, by_px[1]]], dtype=np.float64)
    size = (image.shape[1], image.shape[0])
    out = cv2.warpAffine(
        image.astype(np.float32), move, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
    )
    return np.asarray(out, dtype=np.float64)
