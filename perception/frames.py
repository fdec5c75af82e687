"""What the cameras return is checked where it enters: other than frames as ordered is refused in words."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.rig import SensorCalibration
from executive.types import Centres, Images, Window

_MOST_SATURATED = 0.1  # share of pixels; they do not tell their noise, which is taken from all of them


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
