"""How well a pose explains the images: ground where nothing hides it, shades where the rover is, its shadow.

What the rover's shades and its shadow look like in this light is not known: for each pose the brightnesses
that explain the image best are solved for (variable projection), so that only geometry is left to judge.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from executive.core.types import Array
from perception.outline.passive.background import Background
from perception.outline.passive.drawing import Artist, Drawing, Stands

_SHADE_SIGMA = 0.6  # of a shade's brightness, over the ground's
_SHADE_PX, _HARDLY = 4.0, 0.02  # pixels that a shade must fill to be judged by its own brightness
_SHADOW, _SHADOW_SIGMA = 0.6, 0.3  # share of light missing in the shadow
_DETAIL = 0.05  # first guess of what the drawing leaves out, over the ground's brightness
_SHADOW_DETAIL = 0.3
_LEAST_DETAIL = 0.01
_UNEVEN_M = 0.015  # of the ground about the plane that the shadow is drawn on


@dataclass(frozen=True, eq=False)
class CameraScene:
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
    """What the drawing leaves out, as standard deviations [counts]: of the rover's shades, of its shadow, and
    of the ground's as long as the pose is off."""

    rover: float
    shadow: float
    ground: float = 0.0


@dataclass(frozen=True, eq=False)
class Match:
    """Residuals (n, h, w) of n poses [counts], and how the first of them is drawn."""

    residual: Array
    drawing: Drawing


def first_detail(scene: CameraScene) -> Detail:
    """What to allow for before anything is known."""
    rover, shadow = _DETAIL * scene.brightness, _SHADOW_DETAIL * scene.brightness
    return Detail(rover, shadow, rover)


def weigh(scene: CameraScene, stands: Stands, detail: Detail) -> Array:
    """How far each pixel (h, w) may be off what is drawn [counts], with the rover at the first pose."""
    drawing = scene.artist.draw(stands)
    rover = drawing.shades[0].sum(axis=0)
    variance = scene.noise**2 + drawing.ground[0] * (scene.background.sigma**2 + detail.ground**2)
    variance = variance + rover * detail.rover**2 + _about_shadow(scene, drawing) * detail.shadow**2
    sigma: Array = np.sqrt(variance)
    return sigma


def match(scene: CameraScene, stands: Stands, sigma: Array) -> Match:
    """Explain the image by each of the poses, pixels weighed by their `sigma` (h, w)."""
    drawing = scene.artist.draw(stands)
    background = scene.background.counts.astype(np.float32)
    inverse = (1 / sigma).astype(np.float32)
    target = (scene.image.astype(np.float32) - background * drawing.ground) * inverse
    columns = np.concatenate([drawing.shades, (-background * drawing.shadow)[:, None]], axis=1) * inverse
    n, k = columns.shape[:2]
    A, b = columns.reshape(n, k, -1), target.reshape(n, -1, 1)
    expected = np.append(np.full(k - 1, scene.brightness), _SHADOW)
    weight = _knowledge(scene, drawing)
    gram = (A @ A.transpose(0, 2, 1)).astype(np.float64) + weight[:, None] * np.eye(k)
    right = (A @ b).astype(np.float64)[..., 0] + weight * expected
    level = np.linalg.solve(gram, right[..., None]).astype(np.float32)
    rest = (b - A.transpose(0, 2, 1) @ level)[..., 0]
    return Match(rest.reshape(n, *sigma.shape).astype(np.float64) * sigma, drawing)


def _knowledge(scene: CameraScene, drawing: Drawing) -> Array:
    """Weights (n, s + 1) of what is expected of shades and shadow; a shade that hardly shows has no say."""
    shown = np.minimum(drawing.shades.sum(axis=(2, 3)) / _SHADE_PX + _HARDLY, 1.0)
    sigma = np.pad(_SHADE_SIGMA * scene.brightness * shown, ((0, 0), (0, 1)), constant_values=_SHADOW_SIGMA)
    weight: Array = np.asarray(sigma, dtype=np.float64) ** -2.0
    return weight


def refined_detail(scene: CameraScene, found: Match) -> Detail:
    """What the drawing was seen to leave out at the first pose."""
    least = _LEAST_DETAIL * scene.brightness
    rover = found.drawing.shades[0].sum(axis=0)
    return Detail(
        max(_rms(found.residual[0][rover > 0.5]), least),
        max(_rms(found.residual[0][_about_shadow(scene, found.drawing) > 0.5]), least),
    )


def _about_shadow(scene: CameraScene, drawing: Drawing) -> Array:
    """Share of shadow in or near each pixel: ground is no plane, and a shadow's edge lies where it lies."""
    reach = round(_UNEVEN_M * scene.pixels_a_metre)
    size = (2 * reach + 1, 2 * reach + 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, size)
    return np.asarray(cv2.dilate(drawing.shadow[0], kernel) * drawing.ground[0], dtype=np.float64)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0
