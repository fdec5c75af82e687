"""The map's geometry: site metres to pixels, x to the right and y up, the same scale in both."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from executive.core.types import Array, Segment, Vec2

_LABEL_PX = 40.0


@dataclass(frozen=True)
class MapFrame:
    """A rectangle of the site, drawn at `px_per_m` with its upper left corner at `left_px`, `top_px`."""

    x0_m: float
    y0_m: float
    x1_m: float
    y1_m: float
    px_per_m: float
    left_px: float = 0.0
    top_px: float = 0.0

    @classmethod
    def around(cls, xy_m: Array, width_px: float, pad_m: float, heights_px: Vec2) -> MapFrame:
        """The frame that holds all points (n, 2) with a border, of this width, its height within limits.

        The border is `pad_m` wide, or wide enough for a label where that is little on paper.
        """
        low, high = xy_m.min(axis=0) - pad_m, xy_m.max(axis=0) + pad_m
        size_px = np.array([width_px, heights_px[1]])
        scale = float((size_px / (high - low)).min())
        if pad_m * scale < _LABEL_PX:
            low, high = low + pad_m, high - pad_m
            scale = float(((size_px - 2 * _LABEL_PX) / np.maximum(high - low, 1e-9)).min())
            low, high = low - _LABEL_PX / scale, high + _LABEL_PX / scale
        middle = (low + high) / 2
        half_x = width_px / scale / 2
        half_y = max(high[1] - low[1], heights_px[0] / scale) / 2
        return cls(middle[0] - half_x, middle[1] - half_y, middle[0] + half_x, middle[1] + half_y, scale)

    @property
    def width_px(self) -> float:
        return (self.x1_m - self.x0_m) * self.px_per_m

    @property
    def height_px(self) -> float:
        return (self.y1_m - self.y0_m) * self.px_per_m

    def x(self, x_m: float) -> float:
        return self.left_px + (x_m - self.x0_m) * self.px_per_m

    def y(self, y_m: float) -> float:
        return self.top_px + (self.y1_m - y_m) * self.px_per_m

    def to_px(self, xy_m: Iterable[Sequence[float]]) -> list[Vec2]:
        """Points of the site as points of the drawing."""
        return [(self.x(p[0]), self.y(p[1])) for p in xy_m]

    def holds(self, x_m: float, y_m: float) -> bool:
        return self.x0_m <= x_m <= self.x1_m and self.y0_m <= y_m <= self.y1_m


def corridor(segment: Segment, half_width_m: float) -> list[Vec2]:
    """The corners of the band around a segment, its ends cut square."""
    a, b = segment.start, segment.end
    length = segment.length_m or 1.0
    nx, ny = -(b.y_m - a.y_m) / length * half_width_m, (b.x_m - a.x_m) / length * half_width_m
    return [
        (a.x_m + nx, a.y_m + ny),
        (b.x_m + nx, b.y_m + ny),
        (b.x_m - nx, b.y_m - ny),
        (a.x_m - nx, a.y_m - ny),
    ]


def ellipse(x_m: float, y_m: float, covariance: Array, sigmas: float) -> Array:
    """Outline (37, 2) of the error ellipse of a 2x2 covariance [m²], `sigmas` standard deviations large."""
    values, vectors = np.linalg.eigh(covariance)
    angle = np.linspace(0, 2 * np.pi, 37)
    circle = np.array([np.cos(angle), np.sin(angle)])
    axes = vectors * np.sqrt(np.maximum(values, 0.0)) * sigmas
    return np.asarray((axes @ circle).T + np.array([x_m, y_m]))


def outline(x_m: float, y_m: float, heading_rad: float, length_m: float, width_m: float) -> list[Vec2]:
    """The corners of a rectangle that stands at a pose, its front edge first."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    corners = [(length_m / 2, width_m / 2), (length_m / 2, -width_m / 2)]
    corners += [(-length_m / 2, -width_m / 2), (-length_m / 2, width_m / 2)]
    return [(float(x_m + c * u - s * v), float(y_m + s * u + c * v)) for u, v in corners]
