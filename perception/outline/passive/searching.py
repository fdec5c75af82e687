"""Where to start: the outlines of rover and shadow, at several headings, laid over what has changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from executive.core.types import Array
from perception.outline.passive.alignment import SIZE, Start
from perception.outline.passive.coverage import Layers
from perception.outline.passive.matching import CameraScene
from perception.outline.passive.solids import Indices

_CHANGED = 3.0  # sigmas from which a pixel speaks for the rover rather than for the ground
_MOST = 6.0
_HEADINGS_RAD = np.radians([-12.0, -6.0, 0.0, 6.0, 12.0])
_MARGIN_PX = 2
_SUN_STEPS_RAD = np.radians([7.0, 3.0])
_SUN_LIMITS_RAD = np.radians([10.0, 80.0])
_REACH_M, _STEP_ALONG_M = 0.30, 0.03


@dataclass(frozen=True, eq=False)
class Guess:
    """Parameters (6,) to start from, the sun (2,) that goes with them, and their score."""

    parameters: Array
    sun_rad: Array
    score: float


def search(scenes: Sequence[CameraScene], start: Start, focal_px: float, suns_rad: Array) -> list[Guess]:
    """A start for each heading, with the best of the suns (n, 2), azimuth and elevation; best first."""
    turned = np.zeros((len(_HEADINGS_RAD), SIZE))
    turned[:, 5] = _HEADINGS_RAD
    grid = _places(start, focal_px)
    guesses: list[Guess] = []
    for sun_rad in suns_rad:
        under = replace(start, sun_rad=sun_rad)
        total = sum(_scores(scene, under, turned, grid) for scene in scenes)
        for heading, scores in zip(turned, np.asarray(total), strict=True):
            best = int(np.argmax(scores))
            guesses.append(Guess(heading + grid[best], sun_rad, float(scores[best])))
    guesses.sort(key=lambda g: -g.score)
    best_of: dict[float, Guess] = {}
    for guess in guesses:
        best_of.setdefault(float(guess.parameters[5]), guess)
    return list(best_of.values())


def likeliest_sun(scenes: Sequence[CameraScene], start: Start, parameters: Array) -> Array:
    """The sun (2,) near that of the start whose shadow of the rover at this pose covers what has changed."""
    sun_rad = start.sun_rad
    for step in _SUN_STEPS_RAD:
        near = sun_rad + step * np.mgrid[-2:3, -2:3].reshape(2, -1).T
        near[:, 1] = np.clip(near[:, 1], *_SUN_LIMITS_RAD)
        stands = start.stands(np.repeat(parameters[None], len(near), axis=0))
        drawn = [scene.artist.draw(replace(stands, sun_rad=near)).shadow for scene in scenes]
        total = sum((_evidence(s) * d).sum(axis=(1, 2)) for s, d in zip(scenes, drawn, strict=True))
        sun_rad = near[int(np.argmax(total))]
    return sun_rad


def _places(start: Start, focal_px: float) -> Array:
    """Parameters (m, 6) of places around the start, a pixel apart across the line of sight."""
    step_m = start.range_m / focal_px
    along = np.arange(-_REACH_M, _REACH_M + 1e-9, _STEP_ALONG_M)
    across = np.arange(-round(_REACH_M / step_m), round(_REACH_M / step_m) + 1) * step_m
    grid = np.zeros((len(along) * len(across), SIZE))
    grid[:, 0], grid[:, 1] = (m.ravel() for m in np.meshgrid(along, across, indexing="ij"))
    return grid


def _scores(scene: CameraScene, start: Start, turned: Array, grid: Array) -> Array:
    """What one camera says for each heading (n, 6) at each place (m, 6): (n, m)."""
    artist = scene.artist.framing(start.stands(turned), _MARGIN_PX)
    outlines = artist.draw(start.stands(turned))
    corner = (artist.window.u - scene.artist.window.u, artist.window.v - scene.artist.window.v)
    here = scene.artist.pixels_of(start.site_body.position_m[None])
    there = scene.artist.pixels_of(start.site_body.position_m + grid[:, :3] @ start.axes.T)
    moves: Indices = np.rint(there - here).astype(np.intp)
    return _overlaps(_evidence(scene), 1 - outlines.ground + outlines.shadow, moves + corner)


def _evidence(scene: CameraScene) -> Array:
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
