"""Where the rover's outline lies best on what moved: each camera's pixels, both on one row.

The lines drawn at an expected pose are a matched filter for moving edges. It does not mind a shadow that
moves along, as its edges are not where the rover's are. The rover looks alike in both cameras, whose rows
run alike, so the best row is one for both.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from perception.frames.steadying import Picture
from perception.geometry.body import Transform
from perception.outline.motion import (
    Fragments,
    clearness,
    near_to,
    slope_of,
)
from perception.outline.silhouette import Outline, Sketch

_ROW_SLACK = 1  # pixels by which the rows of both cameras may part
_STAYS_PX = 2.0
_STEP_REACH_PX = 10  # a little more than the rover drives between two frames


@dataclass(frozen=True, eq=False)
class Lie:
    """How an outline lies: by how much it is off the expected place (u, v) [binned px], how alike lines and
    moving edges are there (correlation), which share of the lines is on some, and the sketch."""

    off_px: Array
    alike: float
    covered: float
    sketch: Sketch


def lay_outlines(
    outlines: list[Outline], edges: list[Picture], expected: Transform, reach_px: int, blur_px: float
) -> list[Lie] | None:
    """Lay the outlines on the edges (h, w) of the cameras that saw anything, within reach of a pose.

    None where the rover is not in their pictures.
    """
    sketches, scores = [], []
    for outline, edge in zip(outlines, edges, strict=True):
        sketch = outline.sketch(expected, blur_px)
        around = None if sketch is None else _cut(edge, sketch, reach_px)
        if sketch is None or around is None:
            return None
        sketches.append(sketch)
        scores.append(_scores(around, sketch))
    row = _common_row(scores)
    lies = []
    for score, sketch, edge in zip(scores, sketches, edges, strict=True):
        top = max(row - _ROW_SLACK, 0)
        band = score[top : row + _ROW_SLACK + 1]
        j, i = (int(x) for x in np.unravel_index(int(band.argmax()), band.shape))
        off = np.array([i, top + j]) - reach_px
        lies.append(Lie(off + _between(score, i, top + j), *support(edge, sketch, off), sketch))
    return lies


def step_between(fragments: list[Fragments], lies: list[Lie]) -> Array | None:
    """By how much (u, v) [px] the outline came on between the two frames.

    The mean of all cameras, which see nearly the same step; None where it leaves their pictures, or other
    edges draw it away from where it lies. All lines near by take part: what moves little changes the same
    pixels in both frames, and these alone would say that it rests.
    """
    was, now = np.zeros((2, 2 * _STEP_REACH_PX + 1, 2 * _STEP_REACH_PX + 1), np.float32)
    for f, lie in zip(fragments, lies, strict=True):
        there = replace(lie.sketch, corner=lie.sketch.corner + np.round(lie.off_px))
        before, after, moved = (_cut(p, there, _STEP_REACH_PX) for p in (f.before, f.lines, f.moved))
        if before is None or after is None or moved is None:
            return None
        was += _scores(clearness(slope_of(before)) * near_to(moved), there)
        now += _scores(after, there)
    came_from, came_to = _peak(was), _peak(now)
    clear = np.abs(came_to).max() <= _STAYS_PX and np.abs(came_from).max() < _STEP_REACH_PX - 1
    return np.asarray(came_to - came_from) if clear else None


def _peak(score: Picture) -> Array:
    """Where scores are best, from their middle (u, v) [px]."""
    row, column = (int(x) for x in np.unravel_index(int(score.argmax()), score.shape))
    return np.array([column, row]) - _STEP_REACH_PX + _between(score, column, row)


def _scores(around: Picture, sketch: Sketch) -> Picture:
    """Scores (2 reach + 1, 2 reach + 1) of the sketch moved over what surrounds it."""
    pattern = sketch.lines - sketch.lines.mean()
    pattern /= float(np.linalg.norm(pattern))
    return np.asarray(cv2.matchTemplate(around, pattern, cv2.TM_CCORR), dtype=np.float32)


def _common_row(scores: list[Picture]) -> int:
    """The row with the best score of all cameras together, each allowed its slack."""
    wide = np.ones((2 * _ROW_SLACK + 1, 1), np.uint8)
    best = sum(cv2.dilate(score.max(axis=1)[:, None], wide) for score in scores)
    return int(np.argmax(best))


def _cut(edge: NDArray[Any], sketch: Sketch, reach_px: int) -> NDArray[Any] | None:
    """The picture where the sketch is, and `reach_px` around it; zero beyond its rim, None if all beyond."""
    height, width = edge.shape
    rows, columns = sketch.lines.shape
    u, v = (int(x) - reach_px for x in sketch.corner)
    left, right = max(u, 0), min(u + columns + 2 * reach_px, width)
    top, bottom = max(v, 0), min(v + rows + 2 * reach_px, height)
    if left >= right or top >= bottom:
        return None
    pad = (top - v, v + rows + 2 * reach_px - bottom, left - u, u + columns + 2 * reach_px - right)
    inside = edge[top:bottom, left:right]
    return np.asarray(cv2.copyMakeBorder(inside, *pad, cv2.BORDER_CONSTANT, value=0), dtype=edge.dtype)


def support(edge: Picture, sketch: Sketch, off: Array) -> tuple[float, float]:
    """Correlation of the lines with the edges that they lie on, and the share of them that lies on any."""
    under = _cut(edge, replace(sketch, corner=sketch.corner + off), 0)
    if under is None or not under.any():
        return 0.0, 0.0
    on = under - under.mean()
    lines = sketch.lines - sketch.lines.mean()
    alike = float((on * lines).sum()) / float(np.linalg.norm(on) * np.linalg.norm(lines))
    return alike, float(sketch.lines[under > 0].sum() / sketch.lines.sum())


def _between(score: Picture, column: int, row: int) -> Array:
    """Where between pixels a paraboloid through the best and its neighbours peaks (u, v)."""
    around = score[row - 1 : row + 2, column - 1 : column + 2].astype(np.float64)
    if around.shape != (3, 3) or row == 0 or column == 0:
        return np.zeros(2)
    slope = np.array([around[1, 2] - around[1, 0], around[2, 1] - around[0, 1]]) / 2
    twist = (around[2, 2] - around[2, 0] - around[0, 2] + around[0, 0]) / 4
    bend_u = around[1, 2] - 2 * around[1, 1] + around[1, 0]
    bend_v = around[2, 1] - 2 * around[1, 1] + around[0, 1]
    H = np.array([[bend_u, twist], [twist, bend_v]])
    if bend_u >= 0 or np.linalg.det(H) <= 0:
        return np.zeros(2)
    peak: Array = np.clip(-np.linalg.solve(H, slope), -1.0, 1.0)
    return peak
