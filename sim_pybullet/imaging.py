"""The full tier: a shot becomes two stacks of images, noise and all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from executive.core.clock import Stopwatch
from executive.core.types import (
    LEFT,
    RIGHT,
    HeadReading,
    Images,
    Shot,
    Window,
)
from sim_pybullet.exposing import full_windows
from sim_pybullet.picture import Picture
from sim_pybullet.scene import SceneState
from sim_pybullet.sensor import Sensor

_PIXELS_AT_ONCE = 4_000_000


class ImageDeveloper:
    """Draws each distinct scene once, adds the LEDs of each distinct mask once, then exposes every frame."""

    def __init__(
        self, picture: Picture, rng: np.random.Generator, stopwatch: Stopwatch | None = None
    ) -> None:
        self._picture = picture
        self._sensor = Sensor(picture.exposure, rng)
        self._stopwatch = stopwatch or Stopwatch()

    def develop(self, shot: Shot, scenes: tuple[SceneState, ...], head: HeadReading, time_s: float) -> Images:
        windows = shot.windows or full_windows(self._picture.rig)
        with self._stopwatch.measure("render"):
            left, right = (self._stack(shot, scenes, side, windows[side]) for side in (LEFT, RIGHT))
        return Images(time_s, shot, windows, (left, right), head)

    def _stack(
        self, shot: Shot, scenes: tuple[SceneState, ...], camera: int, window: Window
    ) -> NDArray[np.uint16]:
        counts = np.empty((len(shot.leds), window.height, window.width), dtype=np.uint16)
        alike: dict[object, dict[int, list[int]]] = {}
        for frame, (scene, leds) in enumerate(zip(scenes, shot.leds, strict=True)):
            alike.setdefault(_looks(scene), {}).setdefault(leds, []).append(frame)
        for masks in alike.values():
            scene = scenes[next(iter(masks.values()))[0]]
            unlit_e = self._picture.unlit_e(scene, camera, window)
            spots, glints = self._picture.spots(scene, camera), self._picture.glints(scene, camera)
            for leds, frames in masks.items():
                lit_e = self._picture.lit_e(unlit_e, spots, scene.seeing.lit(leds), window, glints)
                self._expose(counts, frames, lit_e * np.float32(shot.exposure))
        return counts

    def _expose(self, counts: NDArray[np.uint16], frames: list[int], expected_e: NDArray[np.float32]) -> None:
        at_once = max(1, _PIXELS_AT_ONCE // expected_e.size)
        for first in range(0, len(frames), at_once):
            part = frames[first : first + at_once]
            counts[part] = self._sensor.expose(expected_e, len(part))


def _looks(scene: SceneState) -> object:
    """What tells two scenes apart in an image: everything but the time."""
    return (
        *(scene.T_site(frame).tobytes() for frame in ("body", "arm", "cabin", "plc")),
        scene.head_pan_rad,
        scene.head_tilt_rad,
        scene.rocks,
        scene.led_alive,
        scene.led_factor,
        scene.seeing,
    )
