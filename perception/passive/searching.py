"""Where to start: the outlines of rover and shadow, at several headings, laid over what has changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from executive.types import Array
from perception.passive.alignment import SIZE, Start
from perception.passive.matching import Scene

_CHANGED = 3.0  # sigmas from which a pixel speaks for the rover rather than for the ground
_MOST = 6.0
_HEADINGS_RAD = np.radians([-10.0, -5.0, 0.0, 5.0, 10.0])
_REACH_M, _STEP_ALONG_M = 0.30, 0.03


@dataclass(frozen=True, eq=False)
class Guess:
    """Parameters (8,) to start from and their score."""

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
    for scene in scenes:
        outlines = scene.artist.draw(start.stands(turned))
        covered = 1 - outlines.ground + outlines.shadow
        centre = scene.artist.pixels_of(start.site_body.position_m[None])
        shifts = np.rint(scene.artist.pixels_of(start.stands(grid).position_m) - centre).astype(int)
        total += _overlaps(_evidence(scene), covered, shifts)
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


def _overlaps(evidence: Array, covered: Array, shifts: Array) -> Array:
    """Evidence (n, m) inside outlines (n, h, w) moved by whole pixels (m, 2) as (right, down)."""
    reach = int(np.abs(shifts).max())
    padded = np.pad(evidence, reach, constant_values=-_CHANGED).astype(np.float32)
    scores = []
    for outline in covered:
        field = cv2.matchTemplate(padded, outline.astype(np.float32), cv2.TM_CCORR)
        scores.append(field[shifts[:, 1] + reach, shifts[:, 0] + reach])
    return np.asarray(scores, dtype=np.float64)
