"""Where the patches of one picture of the ground are in another: correlation, coarse then fine.

Normalised correlation knows neither gain nor offset of the light. It is sought at a quarter of the size as
far as the head may have turned unnoticed, then at full size next to what was found, to a part of a pixel. A
patch that resembles nothing is left out; whether enough agree is for the fit to say (head.alignment).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import (
    LEFT,
    RIGHT,
    Array,
    Centres,
    Images,
    Landmarks,
)

Picture = NDArray[np.float32]

PATCHES = 7  # along each side of the frame
_PATCH_PX, _COARSE_PX, _FINE_REACH_PX = 48, 96, 6
_SCALE = 4
REACH_PX = 280  # six degrees
LEAST_ALIKE = 0.6
_TEXTURE_NOISES = 3.0  # a patch whose contrast is below this many pixel noises shows nothing


@dataclass(frozen=True, eq=False)
class Matches:
    """What two pictures of one camera share: pixels (n, 2) in the first and in the second."""

    before_px: Array
    after_px: Array


def matched(
    before: Images | Centres, after: Images | Centres, noise_counts: float
) -> tuple[Matches, Matches]:
    """What two pictures share, left and right; ValueError where they are not of one kind."""
    if isinstance(before, Images) and isinstance(after, Images):
        left, right = (_images(before, after, camera, noise_counts) for camera in (LEFT, RIGHT))
        return left, right
    if isinstance(before, Centres) and isinstance(after, Centres):
        left, right = (_landmarks(before, after, camera) for camera in (LEFT, RIGHT))
        return left, right
    raise ValueError(f"got {type(before).__name__} and {type(after).__name__}, expected two of one kind")


def register(before: Picture, after: Picture, noise_counts: float) -> Matches:
    """Patches of `before` found in `after`, both (h, w) [counts] and of one shape; ValueError otherwise."""
    if before.shape != after.shape or before.ndim != 2 or min(before.shape) < 4 * _COARSE_PX:
        raise ValueError(
            f"got pictures of shape {before.shape} and {after.shape}, "
            f"expected two alike of {4 * _COARSE_PX} or more pixels a side"
        )
    small = _smaller(before), _smaller(after)
    found = []
    for centre in _centres(before.shape):
        patch = _cut(before, centre, _PATCH_PX)
        if patch is None or patch.std() < _TEXTURE_NOISES * noise_counts:
            continue
        coarse = _found(*small, tuple(c / _SCALE for c in centre), _COARSE_PX // _SCALE, REACH_PX // _SCALE)
        if coarse is None:
            continue
        shift = (round(coarse[0] * _SCALE), round(coarse[1] * _SCALE))
        fine = _found(before, after, centre, _PATCH_PX, _FINE_REACH_PX, shift)
        if fine is not None:
            found.append((centre, fine))
    pairs = np.array(found, dtype=np.float64).reshape(-1, 2, 2)
    return Matches(pairs[:, 0], pairs[:, 0] + pairs[:, 1])


def _images(before: Images, after: Images, camera: int, noise_counts: float) -> Matches:
    first, second = (i.counts[camera].mean(axis=0).astype(np.float32) for i in (before, after))
    return register(first, second, noise_counts)


def _landmarks(before: Centres, after: Centres, camera: int) -> Matches:
    if before.ground is None or after.ground is None:
        return Matches(np.empty((0, 2)), np.empty((0, 2)))
    first: Landmarks = before.ground[camera]
    second: Landmarks = after.ground[camera]
    _, i, j = np.intersect1d(first.names, second.names, return_indices=True)
    return Matches(first.uv_px[i], second.uv_px[j])


def _smaller(picture: Picture) -> Picture:
    height, width = picture.shape
    size = (width // _SCALE, height // _SCALE)
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.float32)


def _centres(shape: tuple[int, ...]) -> list[tuple[float, float]]:
    """Middles of the patches (u, v), evenly spread."""
    us, vs = (np.linspace(_COARSE_PX, size - 1 - _COARSE_PX, PATCHES).round() for size in shape[::-1])
    return [(float(u), float(v)) for v in vs for u in us]


def _cut(picture: Picture, centre: tuple[float, ...], size: int) -> Picture | None:
    """The square of pixels around a centre, None where it is not all inside."""
    u, v = (round(c) - size // 2 for c in centre)
    height, width = picture.shape
    if u < 0 or v < 0 or u + size > width or v + size > height:
        return None
    return picture[v : v + size, u : u + size]


def _found(
    before: Picture,
    after: Picture,
    centre: tuple[float, ...],
    size: int,
    reach: int,
    shift: tuple[int, int] = (0, 0),
) -> tuple[float, float] | None:
    """By how much a patch has moved [px], sought within `reach` of `shift`; None if it resembles nothing."""
    patch = _cut(before, centre, size)
    if patch is None:
        return None
    height, width = after.shape
    u, v = (round(c) - size // 2 for c in centre)
    left, top = max(u + shift[0] - reach, 0), max(v + shift[1] - reach, 0)
    right, bottom = min(u + shift[0] + reach + size, width), min(v + shift[1] + reach + size, height)
    if right - left < size + 2 or bottom - top < size + 2:
        return None
    likeness = np.asarray(
        cv2.matchTemplate(after[top:bottom, left:right], patch, cv2.TM_CCOEFF_NORMED), dtype=np.float32
    )
    _, best, _, (i, j) = cv2.minMaxLoc(likeness)
    inside = 0 < i < likeness.shape[1] - 1 and 0 < j < likeness.shape[0] - 1
    if not inside or best < LEAST_ALIKE:
        return None
    du, dv = _vertex(likeness[j, i - 1 : i + 2]), _vertex(likeness[j - 1 : j + 2, i])
    return left + i + du - u, top + j + dv - v


def _vertex(three: Picture) -> float:
    """Where between three values in a row, the middle one the largest, a parabola through them peaks."""
    a, b, c = (float(v) for v in three)
    bend = a - 2 * b + c
    return 0.5 * (a - c) / bend if bend < 0 else 0.0
