"""Frames of a head that vibrates by pixels, brought onto one another, and what its vibration leaves unknown.

A frame is moved as a whole by its Fourier transform, which leaves noise as white and as strong as it was:
eight-tap interpolation takes a fifth of it, and centres would seem that much better than they are. The mean
of the sequence is where the frames are brought to; that the head pointed there on average as well is known
to no better than its sway over the root of the frames.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import fft

from executive.core.types import Array
from perception.geometry.chain import Chain

Frames = NDArray[np.float32]
_ROUNDS = 2
_REFLECTED_PX = 12  # beyond the rim, so that it does not ring
_RIM_PX = 4  # that this spoils all the same


class Movable:
    """Frames (n, h, w) that can be moved, each by as much as it wants; transformed once for all moves."""

    def __init__(self, frames: Frames) -> None:
        self._shape = frames.shape[1:]
        rim = ((0, 0), *((_REFLECTED_PX, _rim_beyond(size)) for size in self._shape))
        padded = np.pad(frames, rim, mode="symmetric")
        self._size = padded.shape[1:]
        self._waves = fft.rfft2(padded)

    def moved_back(self, shift_px: Array) -> Frames:
        """The frames moved by minus their shifts (n, 2)."""
        height, width = self._shape
        rows, columns = fft.fftfreq(self._size[0]), fft.rfftfreq(self._size[1])
        moved = np.empty((len(self._waves), height, width), dtype=np.float32)
        for out, waves, (u, v) in zip(moved, self._waves, shift_px.tolist(), strict=True):
            turned = waves * np.exp(2j * np.pi * v * rows).astype(np.complex64)[:, None]
            turned *= np.exp(2j * np.pi * u * columns).astype(np.complex64)
            whole = fft.irfft2(turned, s=self._size, overwrite_x=True)
            out[:] = whole[_REFLECTED_PX:, _REFLECTED_PX:][:height, :width]
        return moved


def coarse_shifts(frames: Frames, movable: Movable) -> Array:
    """How far each frame (n, h, w) is off their mean (n, 2) [px], u and v, to some 0.2 px, by phase
    correlation."""
    size = frames.shape[2], frames.shape[1]
    window = np.asarray(cv2.createHanningWindow(size, cv2.CV_32F), dtype=np.float32)
    shift = _off(frames, frames[0], window)
    for _ in range(_ROUNDS - 1):
        moved = movable.moved_back(shift)
        shift = shift + _off(moved, moved.mean(axis=0), window)
    return shift


def _off(frames: Frames, reference: Frames, window: Frames) -> Array:
    """How far each frame (n, h, w) is off the others (n, 2) [px], seen against one of them or their mean."""
    light = reference - reference.mean()
    found = [cv2.phaseCorrelate(light, frame - frame.mean(), window)[0] for frame in frames]
    off: Array = np.array(found) - np.mean(found, axis=0)
    return off


def _rim_beyond(size: int) -> int:
    """What is added behind so many pixels, so that their transform is a fast one."""
    least = size + 2 * _REFLECTED_PX
    return int(fft.next_fast_len(least, real=True)) - size - _REFLECTED_PX


def shown_by_all(shape: tuple[int, ...], shift_px: Array) -> NDArray[np.bool_]:
    """Pixels (h, w) that frames with these shifts (n, 2) all show."""
    left, top = _RIM_PX + np.ceil(np.abs(shift_px).max(axis=0)).astype(int)
    inside = np.zeros(shape, dtype=np.bool_)
    inside[top : shape[0] - top, left : shape[1] - left] = True
    return inside


def unknown_px(shift_px: Array) -> float:
    """Standard deviation of the mean pointing of a sequence with these shifts (n, 2), in each axis.

    Few frames tell their own sway badly: of a Gaussian's, guessed from d squares, the mean of the squared
    error over the guess is d / (d - 2), which the guess is widened by.
    """
    frames, squares = len(shift_px), 2 * (len(shift_px) - 1)
    return math.sqrt(float((shift_px**2).sum()) / frames / max(squares - 2, 1))


def shaken(chain: Chain, unknown: Sequence[float]) -> Chain:
    """The chain with a head that points as much less exactly as that says [px], a number a camera."""
    worst = max(unknown, default=0.0)
    if worst == 0.0:
        return chain
    rig, head = chain.rig, chain.rig.head
    half_width = math.sqrt(3.0) * worst / float(chain.model.focal_px.mean())  # of a uniform error as wide
    vibrating = replace(
        head,
        pan_accuracy_rad=math.hypot(head.pan_accuracy_rad, half_width),
        tilt_accuracy_rad=math.hypot(head.tilt_accuracy_rad, half_width),
    )
    return replace(chain, rig=replace(rig, head=vibrating))
