"""A whole scene as one camera sees it: expected electrons, before any noise."""

from __future__ import annotations

from collections import OrderedDict

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.rig import RigCalibration
from executive.types import Window
from sim_pybullet.leds import MarkerOptics, Spot, add_spot
from sim_pybullet.projection import View, head_views
from sim_pybullet.radiometry import Exposure, calibrated_light, spread_sigma_px
from sim_pybullet.render import TerrainRenderer
from sim_pybullet.rocks_view import draw_rock, far_first
from sim_pybullet.rover_view import RoverRenderer
from sim_pybullet.scene import SceneState
from sim_pybullet.sunlight import Sun
from sim_pybullet.terrain import Terrain

Image = NDArray[np.float32]

_KEPT_VIEWS = 8
_NEAREST_M = 0.5


class Picture:
    """Draws scenes. The ground is kept per true head pose and window, as it costs most and changes least."""

    def __init__(self, rig: RigCalibration, terrain: Terrain, sun: Sun, rng: np.random.Generator) -> None:
        self.rig = rig
        self.exposure = Exposure(rig.sensor.bits)
        self._ground = TerrainRenderer(terrain, sun, rng)
        self._rover = RoverRenderer(rig, sun, self._ground.field)
        self._markers = MarkerOptics(rig, calibrated_light(rig), self._ground.field)
        self._kept: OrderedDict[object, tuple[Image, Image]] = OrderedDict()

    def view(self, scene: SceneState, camera: int) -> View:
        """The camera (LEFT or RIGHT) as it truly stands."""
        return head_views(self.rig, scene.head_pan_rad, scene.head_tilt_rad)[camera]

    def unlit_e(self, scene: SceneState, camera: int, window: Window) -> Image:
        """Expected image (h, w) with every LED off [e-]."""
        view = self.view(scene, camera)
        ground, range_m = self._ground_of(scene, camera, view, window)
        image = ground.copy()
        self._rover.shade_ground(image, scene, view, window)
        rocks = far_first(scene.rocks, view.position_site_m)
        rover_m = float(np.linalg.norm(scene.T_site_body[:3, 3] - view.position_site_m))
        before = [r for r in rocks if float(np.linalg.norm(r.centre_site_m - view.position_site_m)) > rover_m]
        for rock in before:
            draw_rock(image, range_m, rock, self._ground.field, self._ground.sun, view, window)
        self._rover.draw(image, scene, view, window)
        for rock in rocks[len(before) :]:
            draw_rock(image, range_m, rock, self._ground.field, self._ground.sun, view, window)
        # One blur for the whole image, that of the rover's range: it is what the picture is taken for.
        blur_px = spread_sigma_px(self.rig.sensor, max(rover_m, _NEAREST_M))
        blurred = cv2.GaussianBlur(image, (0, 0), blur_px, borderType=cv2.BORDER_REPLICATE)
        return np.asarray(blurred * np.float32(self.exposure.ground_e))

    def spots(self, scene: SceneState, camera: int) -> list[Spot]:
        """The markers as they would show in this camera if lit."""
        return self._markers.spots(scene, self.view(scene, camera))

    def lit_e(self, unlit_e: Image, spots: list[Spot], leds: int, window: Window) -> Image:
        """The unlit image with the LEDs of the mask `leds` (bit i = marker i) added [e-]."""
        image = unlit_e.copy()
        for index, spot in enumerate(spots):
            if leds >> index & 1:
                add_spot(image, spot, window)
        return image

    def forget(self) -> None:
        """Drop the kept ground, as after a change of the world."""
        self._kept.clear()

    def _ground_of(self, scene: SceneState, camera: int, view: View, window: Window) -> tuple[Image, Image]:
        key = (scene.head_pan_rad, scene.head_tilt_rad, camera, window, scene.rocks)
        if key not in self._kept:
            self._kept[key] = self._ground.ground(view, window, scene.rocks)
            while len(self._kept) > _KEPT_VIEWS:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]
