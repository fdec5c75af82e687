"""Frames of a head that trembles by pixels, brought onto one another, and what its trembling leaves unknown.

A frame is moved as a whole, noise included, by eight-tap interpolation: that takes some 5 % of the noise and
leaves the markers what they are. The mean of the sequence is where the frames are brought to; that the head
pointed there on average as well is known to no better than its sway over the root of the frames.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.types import Array
from perception.chain import Chain

Frames = NDArray[np.float32]
_ROUNDS = 2
_RIM_PX = 4  # that the interpolation spoils


def coarse_shifts(frames: Frames) -> Array:
    """How far each frame (n, h, w) is off their mean (n, 2) [px], u and v, to some 0.2 px, by phase
    correlation."""
    size = frames.shape[2], frames.shape[1]
    window = cv2.createHanningWindow(size, cv2.CV_32F)
    shift, moved, reference = np.zeros((len(frames), 2)), frames, frames[0]
    for _ in range(_ROUNDS):
        light = reference - reference.mean()
        shift = shift + [cv2.phaseCorrelate(light, frame - frame.mean(), window)[0] for frame in moved]
        shift -= shift.mean(axis=0)
        moved = moved_back(frames, shift)
        reference = moved.mean(axis=0)
    return shift


def moved_back(frames: Frames, shift_px: Array) -> Frames:
    """Frames (n, h, w) moved by minus their shifts (n, 2)."""
    moved = np.empty_like(frames)
    flags = cv2.INTER_LANCZOS4 | cv2.WARP_INVERSE_MAP
    for out, image, (u, v) in zip(moved, frames, shift_px.tolist(), strict=True):
        there, (height, width) = np.array([[1.0, 0.0, u], [0.0, 1.0, v]]), image.shape
        out[:] = cv2.warpAffine(image, there, (width, height), flags=flags, borderMode=cv2.BORDER_REPLICATE)
    return moved


def shown_by_all(shape: tuple[int, ...], shift_px: Array) -> NDArray[np.bool_]:
    """Pixels (h, w) that frames with these shifts (n, 2) all show."""
    left, top = _RIM_PX + np.ceil(np.abs(shift_px).max(axis=0)).astype(int)
    inside = np.zeros(shape, dtype=np.bool_)
    inside[top : shape[0] - top, left : shape[1] - left] = True
    return inside


def unknown_px(shift_px: Array) -> float:
    """Standard deviation of the mean pointing of a sequence with these shifts (n, 2), in each axis."""
    return float(np.sqrt((shift_px**2).mean() / len(shift_px)))


def shaken(chain: Chain, unknown: Sequence[float]) -> Chain:
    """The chain with a head that points as much less exactly as that says [px], a number a camera."""
    worst = max(unknown, default=0.0)
    if worst == 0.0:
        return chain
    rig, head = chain.rig, chain.rig.head
    half_width = math.sqrt(3.0) * worst / float(chain.model.focal_px.mean())  # of a uniform error as wide
    trembling = replace(
        head,
        pan_accuracy_rad=math.hypot(head.pan_accuracy_rad, half_width),
        tilt_accuracy_rad=math.hypot(head.tilt_accuracy_rad, half_width),
    )
    return replace(chain, rig=replace(rig, head=trembling))
