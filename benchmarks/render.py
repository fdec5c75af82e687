"""What pictures cost: first and later calls per window and range, and noise per frame [ms].

Run from the project's root: `python -m benchmarks.render`.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from executive.core.clock import Stopwatch
from executive.core.rig import RigCalibration
from executive.core.types import LEFT, Vec2, Window
from sim_pybullet.picture import Picture
from sim_pybullet.procedural import Relief, make_ground
from sim_pybullet.projection import about_y, about_z
from sim_pybullet.scene import Rock, SceneState
from sim_pybullet.sensor import Sensor
from sim_pybullet.sunlight import Sun
from sim_pybullet.terrain import Terrain

_RIG = RigCalibration()


def best_ms(run: Callable[[], object], times: int = 5) -> float:
    """The shortest of several runs [ms]."""
    spent = []
    for _ in range(times):
        watch = Stopwatch()
        run()
        spent.append(watch.elapsed_s() * 1e3)
    return min(spent)


def rocky_ground(rng: np.random.Generator, low_m: Vec2 = (-2.0, -8.0)) -> tuple[Terrain, tuple[Rock, ...]]:
    """A 16 m square with 60 rocks."""
    terrain = make_ground(Relief(0.012, 6), low_m, 16.0, 0.02, rng)
    rocks = []
    for _ in range(60):
        x, y, radius = rng.uniform(1, 13), rng.uniform(-5, 5), 0.02 + min(rng.exponential(0.035), 0.18)
        rocks.append(Rock((x, y, terrain.height(x, y) + 0.2 * radius), radius))
    return terrain, tuple(rocks)


def scene_at(terrain: Terrain, range_m: float, rocks: tuple[Rock, ...]) -> SceneState:
    """The rover straight ahead of the head, level, cabin down."""
    z = terrain.height(range_m, 0.0)
    body = np.eye(4)
    body[:3, :3], body[:3, 3] = about_z(0.5), (range_m, 0.0, z)
    arm = body @ _shifted(_RIG.cabin.arm_pivot_body_m)
    cabin = arm @ _shifted((_RIG.cabin.arm_length_m, 0.0, 0.0))
    plc = cabin @ _shifted(_RIG.cabin.plc_offset_cabin_m)
    tilt = math.atan2(_RIG.head.mast_height_m - z - 0.1, range_m)
    return SceneState(0.0, body, arm, cabin, plc, 0.0, 0.0, 0.0, tilt, rocks)


def _shifted(by_m: tuple[float, float, float]) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = about_y(0.0), by_m
    return T


def main() -> None:
    terrain, rocks = rocky_ground(np.random.default_rng(3))
    picture = Picture(_RIG, terrain, Sun(), np.random.default_rng(1))
    print("range  window   first   later   0.4/2 ms aim: noise a frame")
    sensor = Sensor(picture.exposure, np.random.default_rng(2))
    for range_m in (2.0, 3.0, 5.0, 10.0):
        scene = scene_at(terrain, range_m, rocks)
        centre = picture.spots(scene, LEFT)[0]
        for size in (128, 256, 300, 1024):
            u = int(np.clip(centre.u_px - size / 2, 0, 1024 - size))
            v = int(np.clip(centre.v_px - size / 2, 0, 1024 - size))
            window = Window(u, v, size, size)

            def fresh(scene: SceneState = scene, window: Window = window) -> None:
                picture.forget()
                picture.unlit_e(scene, LEFT, window)

            first = best_ms(fresh)
            later = best_ms(lambda: picture.unlit_e(scene, LEFT, window))  # noqa: B023  called at once
            image = picture.unlit_e(scene, LEFT, window)
            frames = 20 if size < 1024 else 2
            noise = best_ms(lambda: sensor.expose(image, frames)) / frames  # noqa: B023  called at once
            print(f"{range_m:4.0f} m  {size:5d}  {first:6.1f}  {later:6.1f}  {noise:6.2f}")


if __name__ == "__main__":
    main()
