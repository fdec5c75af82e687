"""Where to start: the outlines of rover and shadow, at several headings, laid over what has changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from executive.types import Array
from perception.passive.alignment import SIZE, Start
from perception.passive.coverage import Layers
from perception.passive.matching import Scene
from perception.passive.solids import Indices

_CHANGED = 3.0  # sigmas from which a pixel speaks for the rover rather than for the ground
_MOST = 6.0
_HEADINGS_RAD = np.radians([-12.0, -6.0, 0.0, 6.0, 12.0])
_MARGIN_PX = 2
_REACH_M, _STEP_ALONG_M = 0.30, 0.03


@dataclass(frozen=True, eq=False)
class Guess:
    """Parameters (6,) to start from and their score."""

    parameters: Array
    score: float


def search(scenes: Sequence[Scene], start: Start, focal_px: float) -> list[Guess]:
    """A start for each heading, best first."""
    turned = np.zeros((len(_HEADINGS_RAD), SIZE))
    turned[:, 5] = _HEADINGS_RAD
    step_m = start.range_m / focal_px
    along = np.arange(-_REACH_M, _REACH_M + 1e-9, _STEP_ALONG_M)
    across = np.arange(-round(_REACH_M / step_m), round(_REACH_M / step_m) + 1) * step_m
    grid = np.zeros((len(along) * len(across), SIZE))
    grid[:, 0], grid[:, 1] = (m.ravel() for m in np.meshgrid(along, across, indexing="ij"))
    total = np.zeros((len(turned), len(grid)))
    places = start.site_body.position_m + grid[:, :3] @ start.axes.T
    for scene in scenes:
        artist = scene.artist.framing(start.stands(turned), _MARGIN_PX)
        outlines = artist.draw(start.stands(turned))
        corner = (artist.window.u - scene.artist.window.u, artist.window.v - scene.artist.window.v)
        here = scene.artist.pixels_of(start.site_body.position_m[None])
        moves: Indices = np.rint(scene.artist.pixels_of(places) - here).astype(np.intp)
        total += _overlaps(_evidence(scene), 1 - outlines.ground + outlines.shadow, moves + corner)
    guesses = []
    for heading, scores in zip(turned, total, strict=True):
        best = int(np.argmax(scores))
        guesses.append(Guess(heading + grid[best], float(scores[best])))
    return sorted(guesses, key=lambda g: -g.score)


def _evidence(scene: Scene) -> Array:
    """What each pixel says for the rover (positive) or for the ground."""
    off = np.abs(scene.image - scene.background.counts) / np.hypot(scene.background.sigma, scene.noise)
    evidence: Array = np.minimum(off, _MOST) - _CHANGED
    return evidence


def _overlaps(evidence: Array, covered: Layers, places: Indices) -> Array:
    """Evidence (n, m) inside outlines (n, h, w) with their corners at whole pixels (m, 2), column and row."""
    reach = max(covered.shape[1:]) + int(np.abs(places).max())
    padded = np.pad(evidence, reach, constant_values=-_CHANGED).astype(np.float32)
    low, high = places.min(axis=0) + reach, places.max(axis=0) + reach
    part = padded[low[1] : high[1] + covered.shape[1], low[0] : high[0] + covered.shape[2]]
    scores = []
    for outline in covered:
        field = cv2.matchTemplate(part, outline.astype(np.float32), cv2.TM_CCORR)
        scores.append(field[places[:, 1] + reach - low[1], places[:, 0] + reach - low[0]])
    return np.asarray(scores, dtype=np.float64)
