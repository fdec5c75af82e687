"""Motion fragment analysis (MFA): what moved between two frames of one camera (paper, 4.1).

The head's own shake and the change of light are taken out, then pixels that differ by more than the ground's
own unrest are opened, joined into blobs and counted. A rover that creeps by a pixel shows by its edges
alone, so fragments carry how strong an edge of the second frame each of their pixels is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Vec2, Window
from perception.frames.steadying import Picture, lay_onto

LEAST_SIDE_PX = 32
_SMOOTH_PX = 0.8
_SMOOTH_NOISE = 1 / (2 * math.sqrt(math.pi) * _SMOOTH_PX)  # what the smoothing leaves of white noise
_MAD = 1.4826
_SPARSE = 4  # of pixels that tell the unrest
_NEAR_PX = 7
_THRESHOLD = 4.0  # multiples of the unrest
_REGISTRATION_PX = 0.1  # how far off the frames may lie on each other
_CLEAR = 6.0  # unrests, or usual slopes, from which an edge is as clear as can be
_LEAST_AREA_PX = 3  # of a blob, in pixels twice as large
_PLAIN = 2.0  # pixel noises of texture below which there is nothing to recognise
_MOST_UNLIKE = 0.75  # of the ground's texture may differ, by median; the same ground comes to 0.1 to 0.5
_MOST_MOVED = 0.3  # share of the picture; where more differs, the frames do not show one scene


@dataclass(frozen=True, eq=False)
class Fragments:
    """Motion in one camera, in pixels of `binning` x `binning` full ones from `corner_px` on.

    `moved` (h, w) is 1 where something moved, else 0; `edges` (h, w) is how clear an edge of the second frame
    is there, `lines` (h, w) the same of all edges near by: what moves along its own edges does not change
    them. `before` (h, w) is the first frame as the head saw the second; `shaken_px` is by how many full
    pixels the head moved the picture; `region` bounds the largest blob and those near it in the full frame.
    """

    moved: NDArray[np.uint8]
    edges: Picture
    lines: Picture
    before: Picture
    binning: int
    corner_px: tuple[int, int]
    shaken_px: Vec2
    region: Window
    area_px: int


def motion_fragments(
    before: NDArray[np.uint16],
    after: NDArray[np.uint16],
    noise_counts: float,
    corner_px: tuple[int, int] = (0, 0),
    reach_px: float = 400.0,
    binning: int = 1,
) -> Fragments | None:
    """Fragments between two frames (h, w) [counts]; None if nothing moved, or nearly everything.

    `reach_px` is how far from the largest blob others belong to its region. ValueError on frames of unequal
    shape or with sides below 32 px once binned.
    """
    if before.ndim != 2 or before.shape != after.shape or min(before.shape) // binning < LEAST_SIDE_PX:
        raise ValueError(
            f"got frames of shape {before.shape} and {after.shape}, "
            f"expected two equal, {LEAST_SIDE_PX * binning} or more pixels a side"
        )
    first, second = _binned(before, binning), _binned(after, binning)
    laid = lay_onto(second, first)
    if laid.texture > _PLAIN * noise_counts / binning and laid.rest > _MOST_UNLIKE * laid.texture:
        return None
    slope = slope_of(second)
    unrest = _in_unrests(second - laid.counts, slope, noise_counts / binning)
    moved = _blobs(unrest, rim_px=math.ceil(float(np.abs(laid.shift_px).max())) + 2)
    share = float(np.count_nonzero(moved)) / moved.size
    if not 0 < share < _MOST_MOVED:
        return None
    clear = clearness(slope)
    region, area = _near_largest(moved, reach_px / binning)
    return Fragments(
        moved=moved,
        edges=np.asarray(np.sqrt(clear * np.minimum(unrest, _CLEAR)) * moved, dtype=np.float32),
        lines=clear * near_to(moved),
        before=laid.counts,
        binning=binning,
        corner_px=corner_px,
        shaken_px=(float(-laid.shift_px[0] * binning), float(-laid.shift_px[1] * binning)),
        region=Window(
            corner_px[0] + region.u * binning,
            corner_px[1] + region.v * binning,
            region.width * binning,
            region.height * binning,
        ),
        area_px=area * binning**2,
    )


def _binned(frame: NDArray[np.uint16], binning: int) -> Picture:
    """The mean of every `binning` x `binning` pixels; what is left over at the far sides is dropped."""
    if binning == 1:
        return frame.astype(np.float32)
    height, width = (side // binning for side in frame.shape)
    whole = frame[: height * binning, : width * binning]
    return cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA).astype(np.float32)


def _smooth(picture: Picture) -> Picture:
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), _SMOOTH_PX), dtype=np.float32)


def slope_of(picture: Picture) -> Picture:
    """Slope of the smoothed picture [counts/px]."""
    smooth = _smooth(picture)
    along_u = cv2.Sobel(smooth, cv2.CV_32F, 1, 0, scale=1 / 8)
    along_v = cv2.Sobel(smooth, cv2.CV_32F, 0, 1, scale=1 / 8)
    return np.asarray(cv2.magnitude(along_u, along_v), dtype=np.float32)


def _in_unrests(change: Picture, slope: Picture, noise_counts: float) -> Picture:
    """Size of the change in standard deviations of what does not move.

    Measured robustly, as grain that the sensor does not resolve flickers with each shake; not below what the
    sensor alone makes. On steep slopes the rest of the registration comes on top.
    """
    size = np.abs(_smooth(change))
    usual = _MAD * float(np.median(size[::_SPARSE, ::_SPARSE]))
    usual = max(usual, noise_counts * math.sqrt(2.0) * _SMOOTH_NOISE)
    sigma = cv2.magnitude(np.full_like(slope, usual), np.float32(_REGISTRATION_PX) * slope)
    return np.asarray(size / sigma, dtype=np.float32)


def clearness(slope: Picture) -> Picture:
    """Slopes in multiples of the usual one, none so large that it counts for all the others."""
    usual = max(float(np.median(slope[::_SPARSE, ::_SPARSE])), 1e-3)
    return np.asarray(np.minimum(slope, _CLEAR * usual) / np.float32(usual), dtype=np.float32)


def near_to(moved: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """1 where something moved or did so a few pixels off, else 0."""
    return np.asarray(cv2.dilate(moved, np.ones((_NEAR_PX, _NEAR_PX), np.uint8)), dtype=np.uint8)


def _blobs(unrest: Picture, rim_px: int) -> NDArray[np.uint8]:
    """Where the change stands out, 1 or 0: specks opened away, the rest widened by a pixel all around."""
    mask = (unrest > _THRESHOLD).astype(np.uint8)
    mask[:rim_px], mask[-rim_px:], mask[:, :rim_px], mask[:, -rim_px:] = 0, 0, 0, 0
    two = np.ones((2, 2), np.uint8)
    mask = cv2.dilate(cv2.erode(mask, two, anchor=(0, 0)), two, anchor=(1, 1)).astype(np.uint8)
    return np.asarray(cv2.dilate(mask, np.ones((3, 3), np.uint8)), dtype=np.uint8)


def _near_largest(mask: NDArray[np.uint8], reach_px: float) -> tuple[Window, int]:
    """What bounds the largest blob and those whose middles are within reach of its own, and their area."""
    small = cv2.dilate(mask, np.ones((2, 2), np.uint8))[::2, ::2]  # half as fine, which is fine enough
    _, _, stats, middles = cv2.connectedComponentsWithStats(small, connectivity=8)
    stats, middles = stats[1:], middles[1:]
    areas = stats[:, cv2.CC_STAT_AREA]
    away = 2 * np.linalg.norm(middles - middles[int(areas.argmax())], axis=1)
    kept = stats[(away <= reach_px) & ((areas >= _LEAST_AREA_PX) | (areas == areas.max()))]
    corner = kept[:, [cv2.CC_STAT_LEFT, cv2.CC_STAT_TOP]]
    low = corner.min(axis=0)
    size = (corner + kept[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]).max(axis=0) - low
    u, v, width, height = (2 * int(x) for x in (*low, *size))
    return Window(u, v, min(width, mask.shape[1] - u), min(height, mask.shape[0] - v)), int(
        cv2.countNonZero(mask[v : v + height, u : u + width])
    )
