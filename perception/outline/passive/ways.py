"""From starts to poses: promising headings are followed to their ends, and the ends held against each other.

What a pose is alike by is not smooth: an edge that lies half a pixel off can hold a heading a degree from the
best. Two ways from either side seldom end in the same trap.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from executive.core.ordered_sum import ordered_sum
from executive.core.types import Array
from perception.outline.passive.alignment import Aligned, Start, align
from perception.outline.passive.drawing import Stands
from perception.outline.passive.matching import (
    CameraScene,
    Detail,
    first_detail,
    refined_detail,
    weigh,
)
from perception.outline.passive.searching import likeliest_sun, search

RIVAL = 6.0  # twice the difference in log likelihood below which another pose explains the images as well
_FINE_MARGIN_PX = 5
_FIRST_STEPS, _FINALISTS, _MORE_STEPS = 2, 2, 3
_ROUNDS, _MOST_STEPS = 2, 15  # each round weighs the pixels anew
_APART_SIGMAS = 3.0
_PLANAR = [0, 1, 5]


@dataclass(frozen=True, eq=False)
class Way:
    """How far one start has led: pose, scenes cut to it, and how their pixels are weighed."""

    aligned: Aligned
    scenes: Sequence[CameraScene]
    details: Sequence[Detail]
    sigmas: Sequence[Array]

    def cost_by(self, other: Way, focal_px: float) -> float:
        """What this pose costs in another's scenes and by its weights."""
        mine = self.aligned
        return align(other.scenes, mine.start, mine.parameters, other.sigmas, focal_px, 0).cost


def approached(scenes: Sequence[CameraScene], start: Start, focal_px: float, suns_rad: Array) -> list[Way]:
    """The best two of the headings, some steps on."""
    ways = []
    for guess in search(scenes, start, focal_px, suns_rad):
        under = replace(start, sun_rad=guess.sun_rad)
        close = [_cropped(s, under.stands(guess.parameters[None])) for s in scenes]
        details = [first_detail(s) for s in close]
        sigmas = _sigmas(close, under, guess.parameters, details)
        aligned = align(close, under, guess.parameters, sigmas, focal_px, _FIRST_STEPS)
        ways.append(Way(aligned, close, details, sigmas))
    ways.sort(key=lambda way: way.aligned.cost)
    return [_further(way, way.sigmas, focal_px, _MORE_STEPS) for way in ways[:_FINALISTS]]


def followed(way: Way, focal_px: float, find_sun: bool) -> Way:
    """The way to its end, pixels weighed by what the drawing was seen to leave out."""
    for _ in range(_ROUNDS):
        at = way.aligned
        details = [refined_detail(s, m) for s, m in zip(way.scenes, at.matches, strict=True)]
        if find_sun:
            sun_rad = likeliest_sun(way.scenes, at.start, at.parameters)
            way = replace(way, aligned=replace(at, start=replace(at.start, sun_rad=sun_rad)))
        sigmas = _sigmas(way.scenes, way.aligned.start, at.parameters, details)
        way = _further(replace(way, details=details), sigmas, focal_px, _MOST_STEPS)
    return way


def chosen(ways: Sequence[Way], focal_px: float) -> tuple[Way, float]:
    """The better of the ways, and its lead over another that ends elsewhere; inf without one.

    They are compared by the weights of both, as each thinks well of itself by its own.
    """
    costs = [ordered_sum(way.cost_by(by, focal_px) for by in ways) / len(ways) for way in ways]
    best, *others = sorted(zip(costs, ways, strict=True), key=lambda pair: pair[0])
    leads = [cost - best[0] for cost, way in others if _apart(best[1].aligned, way.aligned)]
    return best[1], min(leads, default=math.inf)


def _further(way: Way, sigmas: Sequence[Array], focal_px: float, steps: int) -> Way:
    at = way.aligned
    aligned = align(way.scenes, at.start, at.parameters, sigmas, focal_px, steps)
    return replace(way, aligned=aligned, sigmas=sigmas)


def _apart(one: Aligned, other: Aligned) -> bool:
    sigma = np.sqrt(np.diag(one.covariance))
    off = np.abs(one.parameters - other.parameters) / sigma
    return bool(off[_PLANAR].max() > _APART_SIGMAS)


def _sigmas(
    scenes: Sequence[CameraScene], start: Start, parameters: Array, details: Sequence[Detail]
) -> list[Array]:
    stands = start.stands(parameters[None])
    return [weigh(s, stands, d) for s, d in zip(scenes, details, strict=True)]


def _cropped(scene: CameraScene, stands: Stands) -> CameraScene:
    """The scene cut to the rover and its shadow at this pose."""
    artist = scene.artist.framing(stands, _FINE_MARGIN_PX)
    top, left = artist.window.v - scene.artist.window.v, artist.window.u - scene.artist.window.u
    part = np.s_[top : top + artist.window.height, left : left + artist.window.width]
    whole = scene.background
    under = replace(whole, counts=whole.counts[part], sigma=whole.sigma[part])
    return replace(scene, image=scene.image[part], background=under, artist=artist)
