"""The terrain as a shaded picture for the map."""

from __future__ import annotations

import base64

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from executive.record.events import TerrainEvent

_LOW, _HIGH = np.array([226.0, 217.0, 203.0]), np.array([247.0, 243.0, 235.0])  # sand, red first
_SUN = np.array([-0.5, 0.5, 0.7])  # from the upper left, as maps are shaded
_TYPICAL_SLOPE = 0.10  # what a typical slope is made to look like; the shading is for reading, not measuring
_LEAST_SLOPE = 0.02


def shaded(terrain: TerrainEvent, smallest_px: int = 700) -> str:
    """A data URI of a JPEG of the whole grid, y up, tinted by height and shaded by slope."""
    z = np.asarray(terrain.elevation_m, dtype=np.float64)
    factor = max(1, min(8, smallest_px // max(1, min(z.shape))))
    fine = np.asarray(
        cv2.resize(z, None, fx=factor, fy=factor, interpolation=cv2.INTER_CUBIC), dtype=np.float64
    )
    fine = np.asarray(cv2.GaussianBlur(fine, (0, 0), 0.6 * factor), dtype=np.float64)
    colours = _tint(fine) * _shade(fine, terrain.step_m / factor)[..., None]
    image: NDArray[np.uint8] = np.clip(colours, 0, 255).astype(np.uint8)[::-1, :, ::-1]
    ok, jpeg = cv2.imencode(".jpg", np.ascontiguousarray(image), [cv2.IMWRITE_JPEG_QUALITY, 82])
    if not ok:
        raise ValueError(f"cannot encode a relief of shape {image.shape}")
    return "data:image/jpeg;base64," + base64.b64encode(jpeg.tobytes()).decode()


def _tint(z: Array) -> Array:
    low, high = np.percentile(z, [2, 98])
    share = np.clip((z - low) / max(high - low, 1e-6), 0, 1)[..., None]
    return np.asarray(_LOW + share * (_HIGH - _LOW))


def _shade(z: Array, step_m: float) -> Array:
    """Brightness by the angle to the sun, 1 on the flat; slopes are scaled until typical ones show."""
    dz_dy, dz_dx = np.gradient(z, step_m)
    steepen = _TYPICAL_SLOPE / max(float(np.sqrt(np.mean(dz_dx**2 + dz_dy**2))), _LEAST_SLOPE)
    normal = np.dstack([-steepen * dz_dx, -steepen * dz_dy, np.ones_like(z)])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    sun = _SUN / np.linalg.norm(_SUN)
    return np.asarray(np.clip(normal @ sun / sun[2], 0.6, 1.14))
