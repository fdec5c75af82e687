"""The box of markers as geometry: which face carries which ArUco marker, and where its corners are."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from yard_robot.rig import MarkerBox

Array = NDArray[np.float64]

FACES = ("top", "front", "back", "left", "right")
"""In the order of their markers' numbers."""

_AXES = {  # outward normal, and what is to the right when one looks at the face, both in `body`
    "top": ((0, 0, 1), (0, -1, 0)),
    "front": ((1, 0, 0), (0, 1, 0)),
    "back": ((-1, 0, 0), (0, -1, 0)),
    "left": ((0, 1, 0), (-1, 0, 0)),
    "right": ((0, -1, 0), (1, 0, 0)),
}


def dictionary() -> cv2.aruco.Dictionary:
    """The dictionary of the markers: 4 x 4 bits, the fifty that differ most."""
    return cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)


def frame(face: str) -> tuple[Array, Array, Array]:
    """Outward normal, right and down of a face as one looks at it, in `body`."""
    normal, right = (np.array(axis, dtype=np.float64) for axis in _AXES[face])
    return normal, right, -np.cross(normal, right)


def on_face(box: MarkerBox, face: str, right_down_m: Array, lift_m: float = 0.0) -> Array:
    """Points (n, 2) of a face, right and down from its middle, in `body`, shape (n, 3)."""
    normal, right, down = frame(face)
    middle = np.array(box.centre_body_m) + normal * (box.edge_m / 2 + lift_m)
    points: Array = middle + right_down_m[:, :1] * right + right_down_m[:, 1:] * down
    return points


def corners_body_m(box: MarkerBox, face: str) -> Array:
    """The marker's corners in OpenCV's order (clockwise from top left), shape (4, 3)."""
    half = box.marker_m / 2
    return on_face(box, face, half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=np.float64))


@cache
def bits(number: int, cells: int) -> NDArray[np.uint8]:
    """The marker's cells, 1 where black, shape (cells, cells), row 0 on top."""
    image = cv2.aruco.generateImageMarker(dictionary(), number, cells)
    return (np.asarray(image) < 128).astype(np.uint8)
