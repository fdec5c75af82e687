"""Makes the stereo pair of either tier for a backend."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from executive.core.clock import Clock, Stopwatch
from executive.core.rig import RigCalibration
from executive.core.types import HeadReading
from sim_pybullet.exposing import Developer, SimCameras
from sim_pybullet.geometric import CentreDeveloper
from sim_pybullet.imaging import ImageDeveloper
from sim_pybullet.leds import MarkerOptics
from sim_pybullet.picture import Picture
from sim_pybullet.radiometry import Exposure, calibrated_light
from sim_pybullet.raycast import HeightField
from sim_pybullet.scene import SceneSource
from sim_pybullet.sunlight import Sun
from sim_pybullet.terrain import Terrain

TIERS = ("full", "geometric")


def make_cameras(
    tier: str,
    rig: RigCalibration,
    clock: Clock,
    scene: SceneSource,
    head: Callable[[], HeadReading],
    terrain: Terrain,
    sun: Sun,
    rng: np.random.Generator,
    stopwatch: Stopwatch | None = None,
) -> SimCameras:
    """The cameras device of a tier; ValueError for a tier that is not in TIERS.

    `scene` gives the true state now, `head` what the encoders say. The backend calls `tick` on the device
    after each tick of time. One generator serves the ground's texture, then all noise.
    """
    return SimCameras(rig, clock, scene, head, _developer(tier, rig, terrain, sun, rng, stopwatch))


def _developer(
    tier: str,
    rig: RigCalibration,
    terrain: Terrain,
    sun: Sun,
    rng: np.random.Generator,
    stopwatch: Stopwatch | None,
) -> Developer:
    if tier == "full":
        return ImageDeveloper(Picture(rig, terrain, sun, rng), rng, stopwatch)
    if tier == "geometric":
        field = HeightField(terrain)
        optics = MarkerOptics(rig, calibrated_light(rig), field)
        return CentreDeveloper(optics, Exposure(rig.sensor.bits), field, rng)
    raise ValueError(f"tier: got {tier!r}, expected one of {', '.join(TIERS)}")
