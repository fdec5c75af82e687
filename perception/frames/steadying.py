"""A frame laid onto another that a shaken head took: moved and re-exposed until most of both agree.

The head's own shake is a shift here, the same for all of the picture. What itself moved between the frames
disagrees and is left out of the fit.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array

Picture = NDArray[np.float32]

LARGEST_SHIFT_PX = 20.0
_MOST_STEPS = 6
_CONVERGED_PX = 0.015
_GAINS = (0.5, 2.0)
_RIM_PX = 6  # of the halved picture, where moving brings in what was not seen
_OUTLIER_MEDIANS = 3.0  # of the difference: two standard deviations
_SPARSE = 2  # of pixels that take part
_RIDGE = 1e-6  # of a direction that the picture does not show: it stays as it is


@dataclass(frozen=True, eq=False)
class Laid:
    """`counts` (h, w) is the frame as the reference's head and light would have it; `shift_px` (u, v) is
    where the frame has what the reference shows at (0, 0). `rest` and `texture` are the medians of what still
    differs, and of what the reference shows besides its usual brightness [counts]."""

    counts: Picture
    shift_px: Array
    rest: float
    texture: float


def lay_onto(reference: Picture, frame: Picture) -> Laid:
    """Lay a frame onto a reference, both (h, w) [counts], 32 or more pixels a side."""
    small, small_frame = _halved(reference), _halved(frame)
    shift, gain, offset, rest = _refined(small, small_frame, _coarse_shift(small, small_frame))
    laid = np.float32(gain) * _moved(frame, 2 * shift) + np.float32(offset)
    shown = _inner(small)
    texture = float(np.median(np.abs(shown - np.median(shown))))
    return Laid(laid, 2 * shift, rest, texture)


def _refined(reference: Picture, frame: Picture, shift: Array) -> tuple[Array, float, float, float]:
    """Shift, gain, offset and the median rest, by Gauss-Newton on the pixels that agree.

    Slopes are the reference's.
    """
    gain, offset, usual = 1.0, 0.0, 0.0
    wanted = _inner(reference)
    along_u = (_inner(reference, 1, 0) - _inner(reference, -1, 0)) / 2
    along_v = (_inner(reference, 0, 1) - _inner(reference, 0, -1)) / 2
    mean = wanted.mean()
    basis = np.stack([along_u, along_v, wanted - mean, np.ones_like(wanted)])
    for _ in range(_MOST_STEPS):
        rest = np.float32(gain) * _inner(_moved(frame, shift)) + np.float32(offset) - wanted
        size = np.abs(rest)
        usual = float(np.median(size[::2]))
        A = basis * (size <= _OUTLIER_MEDIANS * usual + 1e-3)
        G = (A @ A.T).astype(np.float64)
        G += np.diag(_RIDGE * np.diag(G) + 1e-9)
        step = np.linalg.solve(G, -(A @ rest).astype(np.float64))
        shift = np.clip(shift + step[:2], -LARGEST_SHIFT_PX / 2, LARGEST_SHIFT_PX / 2)
        change = float(np.clip(1 + step[2], *_GAINS))
        gain = float(np.clip(gain * change, *_GAINS))
        offset = offset * change + float(step[3] + (1 - change) * mean)
        if np.abs(step[:2]).max() < _CONVERGED_PX:
            break
    return shift, gain, offset, usual


def _coarse_shift(reference: Picture, frame: Picture) -> Array:
    """By phase correlation, which knows no light; none where it says more than a head can shake."""
    window = cv2.createHanningWindow(reference.shape[::-1], cv2.CV_32F)
    shift, _ = cv2.phaseCorrelate(reference - reference.mean(), frame - frame.mean(), window)
    small = max(abs(shift[0]), abs(shift[1])) <= LARGEST_SHIFT_PX / 2
    return np.array(shift) if small else np.zeros(2)


def _halved(picture: Picture) -> Picture:
    size = (picture.shape[1] // 2, picture.shape[0] // 2)
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.float32)


def _moved(picture: Picture, shift_px: Array) -> Picture:
    """The picture with what lies at `shift_px` brought to (0, 0); what comes in repeats the rim."""
    M = np.array([[1.0, 0.0, shift_px[0]], [0.0, 1.0, shift_px[1]]])
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    moved = cv2.warpAffine(picture, M, picture.shape[::-1], flags=flags, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(moved, dtype=np.float32)


def _inner(picture: Picture, du: int = 0, dv: int = 0) -> Picture:
    """Every so-manieth pixel away from the rim, or its neighbour (du, dv), flat."""
    height, width = picture.shape
    rows = slice(_RIM_PX + dv, height - _RIM_PX + dv, _SPARSE)
    columns = slice(_RIM_PX + du, width - _RIM_PX + du, _SPARSE)
    return picture[rows, columns].ravel()
