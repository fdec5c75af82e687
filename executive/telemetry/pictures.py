"""Small pictures of camera counts for the record."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.telemetry.events import ImageEvent

_DARK_PERCENT, _BRIGHT_PERCENT = 0.5, 99.9


def picture(counts: NDArray[np.uint16], camera: str, longest_px: int = 512) -> tuple[ImageEvent, float]:
    """A PNG of one exposure, contrast stretched, no side longer than `longest_px`; and its scale.

    `counts` has shape (height, width). A pixel (u, v) of the exposure lies at (u, v) * scale in the picture.
    """
    scale = min(1.0, longest_px / max(counts.shape))
    dark, bright = np.percentile(counts, [_DARK_PERCENT, _BRIGHT_PERCENT])
    stretched = np.clip((counts - dark) / max(bright - dark, 1.0), 0.0, 1.0) * 255.0
    small = stretched.astype(np.uint8)
    if scale < 1.0:
        height, width = (max(1, round(side * scale)) for side in counts.shape)
        small = cv2.resize(small, (width, height), interpolation=cv2.INTER_AREA)
    ok, png = cv2.imencode(".png", small)
    if not ok:
        raise ValueError(f"cannot encode a picture of shape {counts.shape}")
    return ImageEvent(camera, "png", png.tobytes()), scale
