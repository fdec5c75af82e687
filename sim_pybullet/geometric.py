"""The cheap tier: no images, but marker centres with the error that the full tier was measured to have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import (
    LEFT,
    RIGHT,
    Array,
    Centres,
    HeadReading,
    Landmarks,
    Shot,
    Window,
)
from sim_pybullet.error_model import JOINT_EXCESS, CentreError, centre_error, joint_chance
from sim_pybullet.exposing import full_windows
from sim_pybullet.ground_marks import GroundMarks, nothing_seen
from sim_pybullet.leds import MarkerOptics, Spot
from sim_pybullet.outline_model import Outline
from sim_pybullet.projection import PlacedCamera, scene_views
from sim_pybullet.radiometry import Exposure, spread_reach_px
from sim_pybullet.raycast import HeightField
from sim_pybullet.scene import SceneState

OUTLINE_FRAMES = 3
_OUTLINE_SIGMA, _OUTLINE_PX = 0.15, 64.0
"""How well the outline of a moving rover lies, in pixels that show it so many long or longer."""
LIGHT_CHANGE, SHIFT_PX = 0.05, 0.5
"""How far a frame may be from the mean of its shot; beyond, the detector refuses the images."""
LEAST_LIGHT = 0.05
"""Below, of the light that the exposure was set for, the ground's texture drowns in the noise."""
_ROVER_MIDDLE_BODY_M = np.array([0.0, 0.0, 0.065])


class CentreDeveloper:
    """Answers a shot with `Centres`.

    A marker that is hidden, dead, outside the window or not found by chance is NaN; in a coded shot chance
    finds all or none. A shot in which no LED is lit is one for motion fragments: it answers with the rover's
    projected middle, the mean over its frames, in `uv_px[:, 0]`, as good as `middle_sigma_px` says, and NaN
    elsewhere. A single such frame is a picture: it shows the `ground`. Three and more show the `outline`.
    """

    def __init__(
        self, optics: MarkerOptics, exposure: Exposure, field: HeightField, rng: np.random.Generator
    ) -> None:
        of_marks, of_outline = rng.spawn(2)  # their own chance: the markers' luck stays as it is
        self._optics, self._exposure, self._rng = optics, exposure, rng
        self._marks, self._outline = GroundMarks(field, of_marks), Outline(of_outline)
        self._rig = optics.rig

    def develop(
        self, shot: Shot, scenes: tuple[SceneState, ...], head: HeadReading, time_s: float
    ) -> Centres:
        count = len(self._rig.markers.positions_plc_m)
        uv_px, sigma_px = np.full((2, count, 2), np.nan), np.full((2, count), np.nan)
        windows = shot.windows or full_windows(self._rig)
        if shot.leds == (0,):
            left, right = (self._ground(shot, scenes[0], camera, windows[camera]) for camera in (LEFT, RIGHT))
            return Centres(time_s, shot, uv_px, sigma_px, head, (left, right), self._full(shot, scenes))
        if len(shot.leds) >= OUTLINE_FRAMES and not any(shot.leds):
            uv_px, sigma_px[:] = self._outlined(shot, scenes, windows)
            return Centres(time_s, shot, uv_px, sigma_px, head, saturated=self._full(shot, scenes))
        for camera in (LEFT, RIGHT):
            if any(shot.leds):
                found = self._markers(shot, scenes, camera, windows[camera])
            else:
                found = self._middle(scenes, camera, windows[camera])
            for index, (centre, sigma) in found.items():
                uv_px[camera, index], sigma_px[camera, index] = centre, sigma
        return Centres(time_s, shot, uv_px, sigma_px, head, saturated=self._full(shot, scenes))

    def _exposed(self, scene: SceneState, view: PlacedCamera, shot: Shot) -> Exposure:
        return self._exposure.under((scene.seeing.light + view.lens.veil) * shot.exposure)

    def _full(self, shot: Shot, scenes: tuple[SceneState, ...]) -> tuple[bool, bool]:
        left, right = (
            self._exposed(scenes[-1], view, shot).full for view in scene_views(self._rig, scenes[-1])
        )
        return left, right

    def _markers(
        self, shot: Shot, scenes: tuple[SceneState, ...], camera: int, window: Window
    ) -> dict[int, tuple[Array, float]]:
        scene = scenes[-1]
        view = scene_views(self._rig, scene)[camera]
        exposure = self._exposed(scene, view, shot)
        lost = exposure.full or not steady(scenes, view)
        spots = [
            replace(spot, electrons=spot.electrons * shot.exposure)
            for spot in self._as_wired(scene, self._brightest(scene, view, window))
        ]
        coded = any(leds & (leds - 1) for leds in shot.leds)
        errors = [_error(shot, index, spot, exposure, coded) for index, spot in enumerate(spots)]
        together = joint_chance(errors) if coded else None
        found = {}
        luck = None
        for index, (spot, error) in enumerate(zip(spots, errors, strict=True)):
            # Drawn for every marker, so that one that vanishes does not change the others' luck.
            chance, noise = self._rng.uniform(), self._rng.standard_normal(2)
            luck = chance if luck is None or together is None else luck
            shows = error.snr > 0 and luck < (error.found if together is None else together)
            if shows and not lost and _within(spot, window):
                centre = np.array([spot.u_px, spot.v_px]) + noise * (error.sigma_u_px, error.sigma_v_px)
                found[index] = (centre, error.reported_px)
        return found

    def _ground(self, shot: Shot, scene: SceneState, camera: int, window: Window) -> Landmarks:
        """The ground in a picture; nothing of it where the light is not what it was."""
        view = scene_views(self._rig, scene)[camera]
        if self._exposed(scene, view, shot).full or scene.seeing.light * shot.exposure < LEAST_LIGHT:
            return nothing_seen()
        T = scene.T_site_body
        return self._marks.seen(view, window, T[:3, :3] @ _ROVER_MIDDLE_BODY_M + T[:3, 3])

    def _outlined(
        self, shot: Shot, scenes: tuple[SceneState, ...], windows: tuple[Window, Window]
    ) -> tuple[Array, float]:
        """Where the outline puts the markers; nowhere in frames that differ or are overexposed."""
        scene = scenes[-1]
        views = scene_views(self._rig, scene)
        uv_px, sigma_px = self._outline.seen(
            scene, views, windows, np.array(self._rig.markers.positions_plc_m)
        )
        if any(self._full(shot, scenes)) or not all(steady(scenes, view) for view in views):
            uv_px = np.full_like(uv_px, np.nan)
        return uv_px, sigma_px

    def _as_wired(self, scene: SceneState, spots: list[Spot]) -> list[Spot]:
        """The spots in the order in which the sequencer means to light them; one always lit shows nothing."""
        dark = scene.seeing.always_lit
        return [
            replace(spots[led], electrons=0.0) if dark >> led & 1 else spots[led]
            for led in scene.seeing.wiring[: len(spots)]
        ]

    def _brightest(self, scene: SceneState, view: PlacedCamera, window: Window) -> list[Spot]:
        """Of each LED and its reflections in the window, the one that a detector would take for it."""
        spots = self._optics.spots(scene, view)
        for led, glint in self._optics.glints(scene, view):
            if _within(glint, window):
                spots[led] = max(spots[led], glint, key=lambda spot: spot.electrons)
        return spots

    def _middle(
        self, scenes: tuple[SceneState, ...], camera: int, window: Window
    ) -> dict[int, tuple[Array, float]]:
        seen = []
        for scene in scenes:
            view = scene_views(self._rig, scene)[camera]
            T = scene.T_site_body
            seen.append(view.project(T[:3, :3] @ _ROVER_MIDDLE_BODY_M + T[:3, 3])[0])
        middle = np.mean(seen, axis=0)
        away = scenes[-1].T_site_body[:3, 3] - view.position_site_m
        sigma_px = middle_sigma_px(self._rig, float(np.linalg.norm(away)))
        noise = sigma_px * self._rng.standard_normal(2)
        inside = (
            window.u <= middle[0] < window.u + window.width
            and window.v <= middle[1] < window.v + window.height
        )
        return {0: (middle + noise, sigma_px)} if inside else {}


def middle_sigma_px(rig: RigCalibration, range_m: float) -> float:
    """Standard deviation of a moving rover's middle, as measured in the full tier (benchmarks/motion.py)."""
    length_px = rig.cameras[0].focal_px * rig.rover.length_m / range_m
    return _OUTLINE_SIGMA * max(1.0, length_px / _OUTLINE_PX)


def _error(shot: Shot, index: int, spot: Spot, exposure: Exposure, coded: bool) -> CentreError:
    """One marker's error: against the dark frames, or in a code against all where it is off."""
    lit = sum(leds >> index & 1 for leds in shot.leds)
    if coded:
        return centre_error(spot, exposure, lit, len(shot.leds) - lit, JOINT_EXCESS)
    return centre_error(spot, exposure, lit, shot.leds.count(0))


def _within(spot: Spot, window: Window) -> bool:
    """Whether the whole spot falls into the window."""
    reach = spread_reach_px(spot.size_px, spot.sigma_px) / 2
    return bool(
        window.u + reach <= spot.u_px <= window.u + window.width - 1 - reach
        and window.v + reach <= spot.v_px <= window.v + window.height - 1 - reach
    )


def steady(scenes: tuple[SceneState, ...], view: PlacedCamera) -> bool:
    """Whether the frames of a shot show one scene: the same light, from a head that stands still."""
    light = np.array([scene.seeing.light for scene in scenes])
    head = np.array([(scene.head_pan_rad, scene.head_tilt_rad) for scene in scenes])
    change = np.abs(light - light.mean()).max()
    shift_px = view.camera.focal_px * np.hypot(*(head - head.mean(axis=0)).T).max()
    return bool(change <= LIGHT_CHANGE and shift_px <= SHIFT_PX)
