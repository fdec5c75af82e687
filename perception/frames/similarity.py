"""Are the frames of a sequence comparable? Each is fitted by the mean frame, moved and re-exposed.

A frame that shows the same scene under slightly other light, from a head that quivers a little, is
    frame = mean - du * mean_u - dv * mean_v + gain * (mean - average) + offset + noise.
The fit is taken out of the frame (it would leak background texture into the difference image) as long as
it is small; a large one, or a large rest, means that the sequence does not show one scene. A head that
vibrates by pixels is no such case: its frames are brought onto one another first (frames.vibration).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from perception.frames.vibration import (
    Movable,
    coarse_shifts,
    shown_by_all,
    unknown_px,
)
from perception.geometry.checks import as_finite
from perception.kernels.frames import Counts, Frames, equalised, mean_and_range

_MARKER_NOISES = 12.0  # a pixel that changes by more is a marker's, not the background's
_VISIBLE_NOISE = 0.5  # a fitted change that alters pixels by less than this is noise fitted to noise
_FINE_ROUNDS = 2
_VISIBLE_SHIFT_PX = 0.3
_MIN_BACKGROUND = 0.5  # share of pixels that must be background for that to make sense


@dataclass(frozen=True)
class SimilarityLimits:
    """How far a frame may be from the sequence's mean; the last two in multiples of the pixel noise."""

    shift_px: float = 0.5
    vibration_px: float = 4.5
    gain: float = 0.10
    offset_noise: float = 12.0
    rest_noise: float = 2.0


@dataclass(frozen=True, eq=False)
class Similarity:
    """Per frame: shift (n, 2) [px], gain (n,), offset and rest (n,) [counts]; frames freed of these.

    `unknown_px` is the standard deviation of where the head pointed on average, beyond its own accuracy.
    `problem` says what makes the sequence unusable, empty if nothing does.
    """

    shift_px: Array
    gain: Array
    offset_counts: Array
    rest_counts: Array
    frames: Frames
    unknown_px: float
    problem: str


def compare(
    stack: NDArray[np.uint16], noise_counts: float, limits: SimilarityLimits | None = None
) -> Similarity:
    """Compare and equalise the frames of a stack (n >= 2, h >= 8, w >= 8) [counts]; ValueError otherwise."""
    if stack.ndim != 3 or stack.shape[0] < 2 or min(stack.shape[1:]) < 8:
        raise ValueError(f"stack: got shape {stack.shape}, expected (2 or more, 8 or more, 8 or more)")
    as_finite("noise_counts", [noise_counts], (1,))
    limits = limits or SimilarityLimits()
    counts = np.array(stack, dtype=np.uint16, order="C")
    mean, varies = mean_and_range(counts)
    still = _equalised(counts, mean, _background(varies, noise_counts), noise_counts, limits)
    if not still.problem:
        return still
    moved = _settled(counts.astype(np.float32), noise_counts, limits)
    return still if moved is None or moved.problem else moved


def _settled(frames: Frames, noise_counts: float, limits: SimilarityLimits) -> Similarity | None:
    """The same for frames of a head that vibrates by pixels; None if it does by too many, or not at all."""
    movable = Movable(frames)
    shift = coarse_shifts(frames, movable)
    found: Similarity | None = None
    for _ in range(_FINE_ROUNDS):
        if not _VISIBLE_SHIFT_PX < np.abs(shift).max() <= limits.vibration_px:
            return None
        moved = movable.moved_back(shift)
        inside = shown_by_all(moved.shape[1:], shift)
        if inside.mean() < _MIN_BACKGROUND / 2:
            return None
        mean = moved.mean(axis=0)
        moved = np.where(inside, moved, mean)
        background = inside & _background(np.ptp(moved, axis=0), noise_counts)
        found = _equalised(moved, mean, background, noise_counts, limits)
        found.frames[:, ~inside] = mean[~inside]
        shift = shift + found.shift_px - found.shift_px.mean(axis=0)
    return None if found is None else replace(found, shift_px=shift, unknown_px=unknown_px(shift))


def _equalised(
    stack: Counts | Frames,
    mean: Frames,
    background: NDArray[np.bool_],
    noise_counts: float,
    limits: SimilarityLimits,
) -> Similarity:
    """Frames freed of what moves and lights them otherwise, and whether they show one scene."""
    basis = _basis(mean)
    weighted = basis * background
    limit = _MARKER_NOISES * noise_counts
    found, left, frames = equalised(stack, mean, basis, weighted, _inverse(weighted, basis), limit)
    fitted, rest = found.astype(np.float64), left.astype(np.float64)
    shift, gain, offset = -fitted[:, :2], fitted[:, 2], fitted[:, 3]
    visible = np.abs(fitted) * basis.std(axis=(1, 2)) > _VISIBLE_NOISE * noise_counts
    problem = _problem(
        shift * visible[:, :2], gain * visible[:, 2], offset / noise_counts, rest / noise_counts, limits
    )
    return Similarity(shift, gain, offset, rest, frames, 0.0, problem)


def _basis(mean: Frames) -> Frames:
    """What a frame is fitted with (4, h, w): gradient along u, along v, contrast, one."""
    along_v, along_u = np.gradient(mean)
    return np.stack([along_u, along_v, mean - mean.mean(), np.ones_like(mean)])


def _background(varies: Counts | Frames, noise_counts: float) -> NDArray[np.bool_]:
    """Pixels (h, w) that no marker lights up; all of them if the whole scene changes."""
    steady: NDArray[np.bool_] = varies < _MARKER_NOISES * noise_counts
    return steady if steady.mean() > _MIN_BACKGROUND else np.ones_like(steady)


def _inverse(weighted: Frames, basis: Frames) -> Frames:
    """Of the Gram matrix (4, 4), for least squares; a direction that the scene does not show gets 0."""
    gram = (weighted.reshape(4, -1) @ basis.reshape(4, -1).T).astype(np.float64)
    scale = np.sqrt(np.diag(gram)) + 1e-9
    inverse = np.linalg.pinv(gram / np.outer(scale, scale), rcond=1e-6) / np.outer(scale, scale)
    return np.array(inverse, dtype=np.float32, order="C")


def _problem(shift: Array, gain: Array, offset: Array, rest: Array, limits: SimilarityLimits) -> str:
    checks = (
        (np.linalg.norm(shift, axis=1), limits.shift_px, "px of shift"),
        (np.abs(gain), limits.gain, "change of contrast"),
        (np.abs(offset), limits.offset_noise, "noise levels of brightness change"),
        (rest, limits.rest_noise, "noise levels of unexplained difference"),
    )
    worst = ((float(values.max()), limit, what) for values, limit, what in checks)
    return "; ".join(
        f"{value:.3g} {what} (at most {limit:g})" for value, limit, what in worst if value > limit
    )
