"""How well a pose explains the images: ground where nothing hides it, shades where the rover is, its shadow.

What the rover's shades and its shadow look like in this light is not known: for each pose the brightnesses that
explain the image best are solved for (variable projection), so that only geometry is left to judge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from executive.types import Array
from perception.passive.background import Background
from perception.passive.drawing import Artist, Drawing, Stands

_SHADE_SIGMA = 0.6  # of a shade's brightness, over the ground's
_SHADOW, _SHADOW_SIGMA = 0.6, 0.3  # share of light missing in the shadow
_DETAIL = 0.05  # first guess of what the drawing leaves out, over the ground's brightness
_SHADOW_DETAIL = 0.3
_LEAST_DETAIL = 0.01
_UNEVEN_M = 0.015  # of the ground about the plane that the shadow is drawn on
_CLIP = 4.0  # residuals beyond so many sigmas count no more than these


@dataclass(frozen=True, eq=False)
class Scene:
    """One camera's part: mean image (h, w) [counts], its noise, the background, who draws the rover; and how
    large a metre is where it is expected."""

    image: Array
    noise: float
    background: Background
    artist: Artist
    pixels_a_metre: float

    @property
    def brightness(self) -> float:
        """Of the ground [counts]."""
        return float(self.background.counts.mean())


@dataclass(frozen=True, eq=False)
class Detail:
    """What the drawing leaves out, as standard deviations [counts]: of the rover's shades, of its shadow."""

    rover: float
    shadow: float


@dataclass(frozen=True, eq=False)
class Match:
    """Residuals (n, h, w) in sigmas of n poses, with what they were made of at the first one."""

    residual: Array
    drawing: Drawing
    unexplained: Array

    @property
    def cost(self) -> Array:
        """Sum of squares (n,), large residuals held back."""
        total: Array = np.minimum(self.residual**2, _CLIP**2).sum(axis=(1, 2))
        return total


def first_detail(scene: Scene) -> Detail:
    """What to allow for before anything is known."""
    return Detail(_DETAIL * scene.brightness, _SHADOW_DETAIL * scene.brightness)


def match(scene: Scene, stands: Stands, detail: Detail) -> Match:
    """Explain the image by each of the poses; weights are those of the first one."""
    drawing = scene.artist.draw(stands)
    sigma = _sigma(scene, drawing, detail)
    background = scene.background.counts
    target = (scene.image - background * drawing.ground) / sigma
    columns = np.concatenate(
        [drawing.shades, (-background * drawing.shadow)[:, None]], axis=1, dtype=np.float32
    )
    columns /= sigma.astype(np.float32)
    n, k = columns.shape[:2]
    A = columns.reshape(n, k, -1)
    b = target.reshape(n, -1, 1).astype(np.float32)
    expected = np.append(np.full(k - 1, scene.brightness), _SHADOW)
    weight = np.append(np.full(k - 1, _SHADE_SIGMA * scene.brightness), _SHADOW_SIGMA) ** -2.0
    gram = (A @ A.transpose(0, 2, 1)).astype(np.float64) + np.diag(weight)
    right = (A @ b).astype(np.float64)[..., 0] + weight * expected
    level = np.linalg.solve(gram, right[..., None]).astype(np.float32)
    rest = (b - A.transpose(0, 2, 1) @ level)[..., 0]
    residual = rest.reshape(n, *sigma.shape).astype(np.float64)
    return Match(residual, drawing, residual[0] * sigma)


def refined_detail(scene: Scene, found: Match) -> Detail:
    """What the drawing was seen to leave out at the first pose."""
    least = _LEAST_DETAIL * scene.brightness
    rover = found.drawing.shades[0].sum(axis=0)
    return Detail(
        max(_rms(found.unexplained[rover > 0.5]), least),
        max(_rms(found.unexplained[_about_shadow(scene, found.drawing) > 0.5]), least),
    )


def joint_cost(matches: Sequence[Match]) -> Array:
    """Cost (n,) of both cameras."""
    total: Array = np.sum([one.cost for one in matches], axis=0)
    return total


def _sigma(scene: Scene, drawing: Drawing, detail: Detail) -> Array:
    rover = drawing.shades[0].sum(axis=0)
    variance = scene.noise**2 + drawing.ground[0] * scene.background.sigma**2
    variance = variance + rover * detail.rover**2 + _about_shadow(scene, drawing) * detail.shadow**2
    sigma: Array = np.sqrt(variance)
    return sigma


def _about_shadow(scene: Scene, drawing: Drawing) -> Array:
    """Share of shadow in or near each pixel: ground is no plane, and a shadow's edge lies where it lies."""
    reach = round(_UNEVEN_M * scene.pixels_a_metre)
    size = (2 * reach + 1, 2 * reach + 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, size)
    return np.asarray(cv2.dilate(drawing.shadow[0], kernel) * drawing.ground[0], dtype=np.float64)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0
