"""What the cameras return is checked where it enters: other than frames as ordered is refused in words.

Frames of the right shape may still be no frames of the scene: read out twice, lost on the way, black. No two
exposures have the same noise in each pixel, so one that repeats another is recognised without a doubt.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.core.rig import SensorCalibration
from executive.core.types import Centres, Images, Window

_MOST_SATURATED = 0.1  # share of pixels; they do not tell their noise, which is taken from all of them
_MOST_LOST = 0.5  # share of frames
_BLACK_COUNTS, _DAY_COUNTS = 4.0, 20.0  # medians: what a dead camera shows at most, one by day at least


def check_frames(images: Images, sensor: SensorCalibration) -> None:
    """ValueError unless both stacks are as many grey frames as ordered, of their windows' size and depth."""
    if len(images.windows) != 2 or len(images.counts) != 2:
        raise ValueError(
            f"got {len(images.windows)} windows and {len(images.counts)} stacks, expected 2 of each"
        )
    for name, window, counts in zip(("left", "right"), images.windows, images.counts, strict=True):
        _check_stack(name, counts, len(images.shot.leds), window, sensor)


def _check_stack(
    name: str, counts: NDArray[Any], frames: int, window: Window, sensor: SensorCalibration
) -> None:
    expected = (frames, window.height, window.width)
    if not isinstance(counts, np.ndarray) or counts.dtype != np.uint16:
        got = getattr(counts, "dtype", type(counts).__name__)
        raise ValueError(f"{name} camera: got frames of {got}, expected uint16")
    if counts.shape != expected or counts.size == 0:
        raise ValueError(
            f"{name} camera: got frames of shape {counts.shape}, expected {expected}, one or more pixels"
        )
    full = 2**sensor.bits - 1
    if (largest := int(counts.max())) > full:
        raise ValueError(f"{name} camera: got counts up to {largest}, expected {full} at most")


def overexposed(data: Images | Centres, sensor: SensorCalibration) -> bool:
    """Whether either camera got too much light."""
    if isinstance(data, Centres):
        return any(data.saturated)
    return any(saturation(counts, sensor) for counts in data.counts)


def saturation(counts: NDArray[np.uint16], sensor: SensorCalibration) -> str:
    """What makes frames unusable because they are overexposed, empty if nothing does."""
    share = np.count_nonzero(counts >= 2**sensor.bits - 1) / counts.size
    if share <= _MOST_SATURATED:
        return ""
    return f"{share:.0%} of the pixels saturated (at most {_MOST_SATURATED:.0%})"


def fresh(counts: NDArray[np.uint16]) -> NDArray[np.bool_]:
    """Which frames (n,) of a stack (n, h, w) are exposures of their own: neither the one before again, nor
    without a single count among others that have some."""
    kept = np.ones(len(counts), dtype=np.bool_)
    row = counts.shape[1] // 2
    for k in np.flatnonzero((counts[1:, row] == counts[:-1, row]).all(axis=1)) + 1:
        kept[k] = not np.array_equal(counts[k], counts[k - 1])
    empty = ~counts[:, row].any(axis=1)
    if not empty.all():
        for k in np.flatnonzero(empty):
            kept[k] &= bool(counts[k].any())
    return kept


def staleness(kept: NDArray[np.bool_]) -> str:
    """What makes a stack unusable of which only these frames are exposures of their own; empty if nothing."""
    lost = int(len(kept) - kept.sum())
    if lost <= _MOST_LOST * len(kept):
        return ""
    return f"{lost} of {len(kept)} frames repeat the one before or are empty (at most {_MOST_LOST:.0%})"


def blackness(levels: tuple[float, float]) -> tuple[str, str]:
    """What makes each camera blind beside the other, from their median counts; empty if nothing does.

    Where both are black it is night, and LEDs may still show.
    """
    left, right = levels
    return _black(left, right), _black(right, left)


def _black(level: float, other: float) -> str:
    if level > _BLACK_COUNTS or other < _DAY_COUNTS:
        return ""
    return f"black ({level:.0f} counts where the other camera has {other:.0f})"


def stuck_pixels(counts: NDArray[np.uint16], sensor: SensorCalibration) -> NDArray[np.bool_]:
    """Pixels (h, w) that show nothing of the scene: full, or empty, in every frame of a stack by day."""
    least, most = counts.min(axis=0), counts.max(axis=0)
    stuck: NDArray[np.bool_] = least >= 2**sensor.bits - 1
    if 2 * np.count_nonzero(most >= _DAY_COUNTS) > most.size:
        stuck |= most == 0
    return stuck
