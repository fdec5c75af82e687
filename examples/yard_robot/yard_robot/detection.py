"""The markers in a picture: which faces of the box show, and where their corners are."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
from executive.core.types import Window

from yard_robot.marker_box import FACES, Array, dictionary
from yard_robot.pole_camera import Image

DARK_COUNTS = 25.0  # a yard in daylight has five times as much
_REFINED_PX = 3  # half the window in which a corner is refined: larger ones take in the cells beside it


@cache
def _detector() -> cv2.aruco.ArucoDetector:
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    parameters.cornerRefinementWinSize = _REFINED_PX
    return cv2.aruco.ArucoDetector(dictionary(), parameters)


def find_markers(image: Image, window: Window) -> dict[str, Array]:
    """Corners (4, 2) of each face's marker, in pixels of the whole sensor, in OpenCV's order."""
    found, numbers, _ = _detector().detectMarkers(image)
    if numbers is None:
        return {}
    origin = np.array([window.u, window.v], dtype=np.float64)
    return {
        FACES[int(number)]: np.asarray(corners[0], dtype=np.float64) + origin
        for number, corners in zip(np.ravel(numbers), found, strict=True)
        if number < len(FACES)
    }


def brightness(image: Image) -> float:
    """The median of the picture [counts]."""
    return float(np.median(image))
