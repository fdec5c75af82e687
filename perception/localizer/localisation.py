"""The work product of one look: what was tried and what came of it, for people and pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.types import (
    Array,
    Centres,
    Images,
    Quality,
    Window,
)


@dataclass(frozen=True, eq=False)
class Localisation:
    """The last look. Pixel arrays are full-frame, shape (2 cameras, n markers, 2), NaN where none.

    `reference` holds the dark mean images of both windows [counts], None in the geometric tier;
    `why` is empty for a success. `frames` and `took_s` are the cost of the whole localisation.
    """

    time_s: float
    quality: Quality
    windows: tuple[Window, Window] | None
    pairs: int
    reference: tuple[NDArray[np.float32], NDArray[np.float32]] | None
    detected_px: Array
    reprojected_px: Array
    residual_px: Array
    chi2: float
    dof: int
    why: str
    frames: int = 0
    took_s: float = 0.0

    @property
    def markers(self) -> int:
        """Markers whose centres entered the pose in both cameras."""
        return int(np.isfinite(self.residual_px).all(axis=(0, 2)).sum())


def picture(reference: NDArray[np.float32]) -> NDArray[np.uint8]:
    """A reference window as an 8-bit picture, stretched between its 1st and 99th percentile."""
    low, high = np.percentile(reference, (1, 99))
    scaled = (reference - low) * (255.0 / max(float(high - low), 1.0))
    return np.asarray(np.clip(scaled, 0, 255), dtype=np.uint8)


def empty(
    time_s: float, quality: Quality, markers: int, data: Images | Centres | None, pairs: int, why: str
) -> Localisation:
    """A look that found nothing."""
    nothing = np.full((2, markers, 2), np.nan)
    windows = data.windows if isinstance(data, Images) else None
    return Localisation(time_s, quality, windows, pairs, None, nothing, nothing, nothing, np.nan, 0, why)
