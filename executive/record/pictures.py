"""Small pictures of camera counts for the record."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Vec2, Window
from executive.record.events import (
    AnnotationsEvent,
    Box,
    ImageEvent,
    Spot,
)

_DARK_PERCENT, _BRIGHT_PERCENT = 0.5, 99.9


def annotated(
    counts: NDArray[np.uint16] | NDArray[np.float32],
    shown: Window,
    camera: str,
    detected: Mapping[int, Vec2],
    reprojected: Mapping[int, Vec2],
    windows: Sequence[Window] = (),
    caption: str = "",
    longest_px: int = 512,
) -> tuple[ImageEvent, AnnotationsEvent]:
    """A picture of the part `shown` of a frame and what was found there, ready for the record.

    `counts` holds that part, shape (height, width). Marker centres by marker number and windows are given
    in pixels of the full frame, where (0, 0) is the middle of the first pixel; a centre that is NaN is left
    out.
    """
    image, scale = picture(counts, camera, longest_px)

    def spots(centres: Mapping[int, Vec2]) -> tuple[Spot, ...]:
        return tuple(
            Spot(marker, _scaled(u - shown.u, scale), _scaled(v - shown.v, scale))
            for marker, (u, v) in sorted(centres.items())
            if math.isfinite(u) and math.isfinite(v)
        )

    boxes = tuple(
        Box((w.u - shown.u) * scale, (w.v - shown.v) * scale, w.width * scale, w.height * scale)
        for w in windows
    )
    return image, AnnotationsEvent(camera, caption, boxes, spots(detected), spots(reprojected))


def _scaled(coordinate: float, scale: float) -> float:
    """A pixel coordinate after scaling, in both with 0 in the middle of the first pixel."""
    return (coordinate + 0.5) * scale - 0.5


def picture(
    counts: NDArray[np.uint16] | NDArray[np.float32], camera: str, longest_px: int = 512
) -> tuple[ImageEvent, float]:
    """A PNG of one exposure, contrast stretched, no side longer than `longest_px`; and its scale.

    `counts` has shape (height, width). The picture is `scale` (1 or less) times its size.
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
