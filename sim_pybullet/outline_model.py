"""How well the full tier fixes a rover by its outline alone, for the cheap tier.

There an outline is told by where it puts the four markers. What the pixels of these are off by makes poses as
far off as those of images, along the line of sight above all (`benchmarks/outline_model.py`).
"""

from __future__ import annotations

import numpy as np

from executive.core.types import Array, Window
from sim_pybullet.projection import PlacedCamera
from sim_pybullet.scene import SceneState

# range [m], error of a marker's place [px], root mean square an axis: near by, pixels are binned
MEASURED = ((3.0, 0.40), (4.0, 0.25), (6.0, 0.18), (10.0, 0.15), (15.0, 0.07), (20.0, 0.07))
FOUND = 0.97
"""Share of outlines that are not refused."""
LEAST_LIGHT, MOST_BLUR_PX = 0.2, 1.0
"""Of the light that the exposure was set for; of a dusty lens."""
_FOOTPRINT_BODY_M = np.array([(x, y, 0.0) for x in (-0.17, 0.17) for y in (-0.08, 0.08)])


Views = tuple[PlacedCamera, PlacedCamera]


class Outline:
    """Draws what an outline says of the markers' places; nothing where it would be refused."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def seen(
        self, scene: SceneState, views: Views, windows: tuple[Window, Window], markers_plc_m: Array
    ) -> tuple[Array, float]:
        """Pixels (2, n, 2) with noise, NaN if refused, and their standard deviation [px]."""
        found = self._rng.uniform() < FOUND
        noise = self._rng.standard_normal((2, len(markers_plc_m), 2))
        T, body = scene.T_site_plc, scene.T_site_body[:3, 3]
        places = markers_plc_m @ T[:3, :3].T + T[:3, 3]
        range_m, sigma_px = zip(*MEASURED, strict=True)
        sigma = float(np.interp(np.linalg.norm(body - views[0].position_site_m), range_m, sigma_px))
        uv_px = np.stack([view.project(places)[0] for view in views])
        whole = all(_whole(scene, view, window) for view, window in zip(views, windows, strict=True))
        return (uv_px + sigma * noise if found and whole and clear(scene) else uv_px * np.nan), sigma


def clear(scene: SceneState) -> bool:
    """Whether there is daylight, nothing hangs on the rover that is not drawn, and lenses are clean."""
    seeing = scene.seeing
    blurred = any(lens.blur_px > MOST_BLUR_PX for lens in seeing.lenses)
    return seeing.light >= LEAST_LIGHT and not blurred and not seeing.screens


def _whole(scene: SceneState, view: PlacedCamera, window: Window) -> bool:
    """Whether the rover's footprint is in the window; what stands on it needs no more room."""
    T = scene.T_site_body
    corners_px, _ = view.project(_FOOTPRINT_BODY_M @ T[:3, :3].T + T[:3, 3])
    low, size = np.array([window.u, window.v]), np.array([window.width, window.height])
    return bool(((corners_px >= low) & (corners_px <= low + size - 1)).all())
