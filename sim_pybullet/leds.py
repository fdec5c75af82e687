"""The LEDs as the cameras see them: where, how bright, and whether anything stands in the way."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from executive.core.rig import RigCalibration
from executive.core.types import Array, Window
from sim_pybullet.projection import PlacedCamera
from sim_pybullet.radiometry import MarkerLight, emission_factor, pixel_spread, spread_sigma_px
from sim_pybullet.raycast import HeightField
from sim_pybullet.scene import Box, Rock, SceneState, screens
from sim_pybullet.seeing import Glint
from sim_pybullet.shape import rover_boxes

_DOME_M = 0.0015  # the light leaves this far above the marker plane


@dataclass(frozen=True)
class Spot:
    """A lit marker in one image: centre and side [px], blur [px], total signal [e-] (0 when hidden)."""

    u_px: float
    v_px: float
    size_px: float
    sigma_px: float
    electrons: float


class MarkerOptics:
    """Turns the LEDs of a scene into spots, and spots into images."""

    def __init__(self, rig: RigCalibration, light: MarkerLight, field: HeightField) -> None:
        self.rig, self._light, self._field = rig, light, field
        self._boxes = rover_boxes(rig)

    def spots(self, scene: SceneState, view: PlacedCamera) -> list[Spot]:
        """What each marker would be in this view if it were lit, in order of index."""
        return [self._spot(index, scene, view) for index in range(len(self.rig.markers.positions_plc_m))]

    def glints(self, scene: SceneState, view: PlacedCamera) -> list[tuple[int, Spot]]:
        """The reflections in this view, each with the LED that it shines with, if that were lit."""
        return [(glint.led, self._glint(glint, scene, view)) for glint in scene.seeing.glints]

    def _glint(self, glint: Glint, scene: SceneState, view: PlacedCamera) -> Spot:
        T = scene.T_site_body
        position = T[:3, :3] @ np.array(glint.position_body_m) + T[:3, 3]
        led = self._spot(glint.led, scene, view)
        uv, _ = view.project(position)
        seen = np.isfinite(uv).all() and not self.hidden(scene, position, view.position_site_m)
        electrons = glint.strength * led.electrons if seen else 0.0
        return replace(led, u_px=float(uv[0]), v_px=float(uv[1]), electrons=electrons)

    def _spot(self, index: int, scene: SceneState, view: PlacedCamera) -> Spot:
        T = scene.T_site_plc
        position = T[:3, :3] @ np.array(self.rig.markers.positions_plc_m[index]) + T[:3, 3]
        uv, depth = view.project(position)
        to_camera = view.position_site_m - position
        range_m = float(np.linalg.norm(to_camera))
        if not np.isfinite(uv).all():
            return Spot(np.nan, np.nan, 1.0, 1.0, 0.0)
        cosine = float(to_camera @ T[:3, 2]) / range_m
        source = position + _DOME_M * T[:3, 2]
        dark = not scene.led_alive[index] or self.hidden(scene, source, view.position_site_m)
        emission = 0.0 if dark else emission_factor(self.rig.markers.emission, cosine)
        return Spot(
            u_px=float(uv[0]),
            v_px=float(uv[1]),
            size_px=view.camera.focal_px * self.rig.markers.size_m / float(depth),
            sigma_px=math.hypot(spread_sigma_px(self.rig.sensor, range_m), view.lens.blur_px),
            electrons=self._light.electrons(range_m, emission, scene.led_factor[index]),
        )

    def hidden(self, scene: SceneState, source_site_m: Array, eye_site_m: Array) -> bool:
        """Whether rover, rocks or ground stand between a point and the camera."""
        return (
            any(_box_blocks(box, scene, source_site_m, eye_site_m) for box in self._boxes)
            or any(rock_blocks(r, source_site_m, eye_site_m) for r in (*scene.rocks, *screens(scene)))
            or self._field.blocks(source_site_m, eye_site_m)
        )


def add_spot(image_e: NDArray[np.float32], spot: Spot, window: Window) -> None:
    """Add a spot to an image (h, w) of a window [e-], in place; what falls outside is lost."""
    if spot.electrons <= 0:
        return
    u, v, patch = pixel_spread(spot.u_px, spot.v_px, spot.size_px, spot.sigma_px)
    row, column = v - window.v, u - window.u
    top, left = max(row, 0), max(column, 0)
    bottom = min(row + patch.shape[0], image_e.shape[0])
    right = min(column + patch.shape[1], image_e.shape[1])
    if bottom <= top or right <= left:
        return
    part = patch[top - row : bottom - row, left - column : right - column]
    image_e[top:bottom, left:right] += (spot.electrons * part).astype(np.float32)


def _box_blocks(box: Box, scene: SceneState, start: Array, end: Array) -> bool:
    """Whether the straight line between two points of `site` passes through a box (slab test)."""
    T = scene.T_site(box.frame)
    a = (start - T[:3, 3]) @ T[:3, :3] - np.array(box.centre_m)
    b = (end - T[:3, 3]) @ T[:3, :3] - np.array(box.centre_m)
    half = np.array(box.size_m) / 2
    step = np.where(np.abs(b - a) < 1e-12, 1e-12, b - a)
    entry, leave = (-half - a) / step, (half - a) / step
    first = float(np.minimum(entry, leave).max())
    last = float(np.maximum(entry, leave).min())
    return max(first, 0.0) < min(last, 1.0)


def rock_blocks(rock: Rock, start: Array, end: Array) -> bool:
    """Whether the straight line between two points of `site` passes through a rock."""
    line, to_centre = end - start, np.asarray(rock.centre_site_m) - start
    share = float(np.clip((to_centre @ line) / (line @ line), 0, 1))
    return bool(np.linalg.norm(to_centre - share * line) < rock.radius_m)
