"""Views of ground that the rover does not stand on, kept for the day when its lights are out.

A view is good for a place if a rover there shows whole in both frames, clear of where the rover stood when
the view was taken. Far off, a rover hides several metres of ground behind it; near by, little but itself.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from executive.core.types import (
    Array,
    Images,
    Vec2,
    Vec3,
    Window,
)
from perception.geometry.chain import Chain
from perception.geometry.prediction import Expectation
from perception.outline.passive import empty_window

REACH_M = 0.19  # of the rover from its middle, whichever way it faces
GHOST_M = 0.21  # likewise, with what its place may be off by
_HEIGHT_M = 0.20  # of the cabin, a little raised
_ROUND = np.array([(math.cos(a), math.sin(a), 0.0) for a in np.arange(8) * math.pi / 4])
MOST = 12  # views of 4 MB
_SIXTEENTHS = 16  # of a count, in which means of counts are kept


def boxes_px(chain: Chain, head_rad: Vec2, places_site_m: Array, reach_m: float) -> Array:
    """Pixels (2, n, 4), first and last column and row as (left, top, right, bottom), that a rover takes
    which reaches so far around places (n, 3) on the ground; NaN where out of sight."""
    rim = np.concatenate([reach_m * _ROUND, reach_m * _ROUND + [0.0, 0.0, _HEIGHT_M]])
    points = (places_site_m[:, None] + rim).reshape(-1, 3)
    uv = chain.model.project(chain.site_ih(head_rad).inverse().apply(points))
    uv = uv.reshape(2, len(places_site_m), len(rim), 2)
    return np.concatenate([uv.min(axis=2), uv.max(axis=2)], axis=-1)


@dataclass(frozen=True, eq=False)
class EmptyView:
    """When and where to the head looked, what the rover then took of both frames (2, 4) [px], and their mean
    images in sixteenths of a count; no images in the geometric tier."""

    time_s: float
    head_rad: Vec2
    ghost_px: Array
    mean: tuple[NDArray[np.uint16], NDArray[np.uint16]] | None = None

    @classmethod
    def before(cls, chain: Chain, time_s: float, head_rad: Vec2, rover_site_m: Vec3) -> EmptyView:
        """What could be seen from there, the rover being where it is; no images yet."""
        ghost_px = boxes_px(chain, head_rad, np.array([rover_site_m]), GHOST_M)[:, 0]
        return cls(time_s, head_rad, ghost_px)

    def of(self, images: Images) -> EmptyView:
        """The same with the means of full frames."""
        left, right = (
            np.rint(_SIXTEENTHS * counts.mean(axis=0, dtype=np.float32)).astype(np.uint16)
            for counts in images.counts
        )
        return replace(self, mean=(left, right))

    def shows(self, chain: Chain, places_site_m: Array, reach_m: float = REACH_M) -> NDArray[np.bool_]:
        """Whether empty ground shows where a rover at these places (n, 3) would: (n,)."""
        box = boxes_px(chain, self.head_rad, places_site_m, reach_m)
        within = (box[..., :2] >= 0) & (box[..., 2:] <= chain.model.size_px[:, None] - 1)
        ghost = self.ghost_px[:, None]
        clear = (box[..., 2:] < ghost[..., :2]) | (box[..., :2] > ghost[..., 2:])
        unhidden = clear.any(axis=-1) | np.isnan(ghost).any(axis=-1)
        return np.asarray((within.all(axis=-1) & unhidden).all(axis=0))

    def windows(self, chain: Chain, expectation: Expectation) -> tuple[Window, Window]:
        """What to look at for the expected rover, head as in this view; ValueError if out of sight."""
        here = replace(expectation, state=replace(expectation.state, head_rad=self.head_rad))
        keep = boxes_px(chain, self.head_rad, expectation.state.site_body.position_m[None], REACH_M)[:, 0]
        left, right = (
            _without(window, self.ghost_px[camera], keep[camera])
            for camera, window in enumerate(empty_window(chain, here))
        )
        return left, right

    def counts(self, windows: tuple[Window, Window]) -> list[Array]:
        """The part of the mean images in these windows, as one frame each (1, h, w) [counts]."""
        if self.mean is None:
            return []
        return [
            mean[None, w.v : w.v + w.height, w.u : w.u + w.width].astype(np.float64) / _SIXTEENTHS
            for mean, w in zip(self.mean, windows, strict=True)
        ]


class EmptyViews:
    """The latest views."""

    def __init__(self, chain: Chain) -> None:
        self._chain = chain
        self._views: deque[EmptyView] = deque(maxlen=MOST)

    def add(self, view: EmptyView) -> None:
        """Keep a view, in place of the oldest if there are many."""
        self._views.append(view)

    def of(self, place_site_m: Vec3, reach_m: float = REACH_M) -> Iterator[EmptyView]:
        """Those that show this place empty, the latest first."""
        place = np.array([place_site_m])
        return (v for v in reversed(self._views) if v.shows(self._chain, place, reach_m)[0])

    def missing(self, places_site_m: Array) -> NDArray[np.bool_]:
        """Which of these places (n, 3) none shows: (n,)."""
        shown = np.zeros(len(places_site_m), dtype=bool)
        for view in self._views:
            shown |= view.shows(self._chain, places_site_m)
        return ~shown


def _without(window: Window, ghost_px: Array, keep_px: Array) -> Window:
    """The largest part of a window that leaves the ghost (4,) out and keeps (4,) in, both [px]."""
    whole = np.array([window.u, window.v, window.u + window.width - 1, window.v + window.height - 1])
    if np.isnan(ghost_px).any() or (whole[2:] < ghost_px[:2]).any() or (whole[:2] > ghost_px[2:]).any():
        return window
    parts = []
    for side in range(4):
        part = whole.copy()
        beyond = ghost_px[(side + 2) % 4]
        part[side] = np.floor(beyond) + 1 if side < 2 else np.ceil(beyond) - 1
        if (part[:2] <= keep_px[:2]).all() and (part[2:] >= keep_px[2:]).all():
            parts.append(part)
    if not parts:
        return window
    u, v, right, bottom = max(parts, key=lambda p: (p[2] - p[0]) * (p[3] - p[1])).astype(int).tolist()
    return Window(u, v, right - u + 1, bottom - v + 1)
