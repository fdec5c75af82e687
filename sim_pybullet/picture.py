"""A whole scene as one camera sees it: expected electrons, before any noise."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.rig import RigCalibration
from executive.core.types import Window
from sim_pybullet.leds import MarkerOptics, Spot, add_spot
from sim_pybullet.projection import PlacedCamera, scene_views
from sim_pybullet.radiometry import Exposure, calibrated_light, spread_sigma_px
from sim_pybullet.render import TerrainRenderer
from sim_pybullet.rocks_view import draw_rock, far_first
from sim_pybullet.rover_view import RoverRenderer
from sim_pybullet.scene import SceneState, screens
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
        self._first_sun = sun
        self._ground = TerrainRenderer(terrain, sun, rng)
        self._rover = RoverRenderer(rig, sun, self._ground.field)
        self._markers = MarkerOptics(rig, calibrated_light(rig), self._ground.field)
        self._kept: OrderedDict[object, tuple[Image, Image]] = OrderedDict()

    def view(self, scene: SceneState, camera: int) -> PlacedCamera:
        """The camera (LEFT or RIGHT) as it truly stands."""
        return scene_views(self.rig, scene)[camera]

    def unlit_e(self, scene: SceneState, camera: int, window: Window) -> Image:
        """Expected image (h, w) with every LED off [e-]."""
        self._follow(scene.seeing.sun or self._first_sun)
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
        for rock in (*rocks[len(before) :], *screens(scene)):
            draw_rock(image, range_m, rock, self._ground.field, self._ground.sun, view, window)
        # One blur for the whole image, that of the rover's range: it is what the picture is taken for.
        spread_px = spread_sigma_px(self.rig.sensor, max(rover_m, _NEAREST_M))
        blur_px = math.hypot(spread_px, view.lens.blur_px)
        blurred = cv2.GaussianBlur(image, (0, 0), blur_px, borderType=cv2.BORDER_REPLICATE)
        lit = blurred * np.float32(self.exposure.ground_e * scene.seeing.light)
        return np.asarray(lit + np.float32(self.exposure.ground_e * view.lens.veil))

    def spots(self, scene: SceneState, camera: int) -> list[Spot]:
        """The markers as they would show in this camera if lit."""
        return self._markers.spots(scene, self.view(scene, camera))

    def glints(self, scene: SceneState, camera: int) -> list[tuple[int, Spot]]:
        """Their reflections, each with its LED."""
        return self._markers.glints(scene, self.view(scene, camera))

    def lit_e(
        self,
        unlit_e: Image,
        spots: list[Spot],
        leds: int,
        window: Window,
        glints: Sequence[tuple[int, Spot]] = (),
    ) -> Image:
        """The unlit image with the LEDs of the mask `leds` (bit i = marker i) and their glints added [e-]."""
        image = unlit_e.copy()
        for index, spot in (*enumerate(spots), *glints):
            if leds >> index & 1:
                add_spot(image, spot, window)
        return image

    def _follow(self, sun: Sun) -> None:
        """Light the scene anew once the sun has moved."""
        if sun != self._ground.sun:
            self._ground.shine(sun)
            self._rover.sun = sun
            self.forget()

    def forget(self) -> None:
        """Drop the kept ground, as after a change of the world."""
        self._kept.clear()

    def _ground_of(
        self, scene: SceneState, camera: int, view: PlacedCamera, window: Window
    ) -> tuple[Image, Image]:
        lander = (scene.seeing.lander_shift_m, scene.seeing.lander_turn_rad)
        key = (scene.head_pan_rad, scene.head_tilt_rad, lander, camera, window, scene.rocks)
        if key not in self._kept:
            self._kept[key] = self._ground.ground(view, window, scene.rocks)
            while len(self._kept) > _KEPT_VIEWS:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]
