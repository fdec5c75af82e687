"""What the cameras showed, for people."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from executive.core.types import LEFT, RIGHT, Array, CameraView, Centres, Images

Pictures = tuple[NDArray[np.float32], NDArray[np.float32]]
"""A picture of each camera's window [counts]."""


def camera_views(
    data: Images | Centres, pictures: Pictures | None, detected_px: Array, reprojected_px: Array
) -> tuple[CameraView, ...]:
    """Left and right view of what was taken, with centres (2, n, 2) in full frames; none without images."""
    if pictures is None or isinstance(data, Centres):
        return ()
    return tuple(
        CameraView(data.windows[k], pictures[k], detected_px[k], reprojected_px[k]) for k in (LEFT, RIGHT)
    )
