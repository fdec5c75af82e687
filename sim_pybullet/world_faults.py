"""The handle through which faults act on the world itself; each change takes effect at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from executive.core.types import Array, Vec2, Vec3
from sim_pybullet.exposing import ExposureLog
from sim_pybullet.leds import rock_blocks
from sim_pybullet.path import ahead_on
from sim_pybullet.projection import scene_views
from sim_pybullet.rocks import obstacle
from sim_pybullet.scene import Rock, screens
from sim_pybullet.soil import Patch, Soil
from sim_pybullet.sunlight import Sun
from sim_pybullet.world import World


@dataclass(frozen=True)
class WorldActivity:
    """What has been done so far, and what a fault may thus have shown in.

    Travel of both belts together [m], how far each motor turned otherwise than commanded [m], frames
    exposed, and in how many of them each LED's line was driven.
    """

    driven_m: float
    astray_m: tuple[float, float]
    frames: int
    lit: tuple[int, ...]

    def since(self, earlier: WorldActivity) -> WorldActivity:
        """What has been done between two tallies."""
        left_m, right_m = (a - b for a, b in zip(self.astray_m, earlier.astray_m, strict=True))
        lit = tuple(a - b for a, b in zip(self.lit, earlier.lit, strict=True))
        return WorldActivity(
            self.driven_m - earlier.driven_m, (left_m, right_m), self.frames - earlier.frames, lit
        )


class WorldFaults:
    """Alters a world; no port leads here. Markers count from 0, sides are 0 left and 1 right."""

    def __init__(self, world: World, exposures: ExposureLog) -> None:
        self.world = world
        self._exposures = exposures

    def tally(self) -> WorldActivity:
        """What has been done so far."""
        tracks = self.world.tracks
        astray_m = (tracks.motors[0].astray_m, tracks.motors[1].astray_m)
        return WorldActivity(tracks.driven_m, astray_m, self._exposures.frames, tuple(self._exposures.driven))

    def set_led(self, marker: int, alive: bool) -> None:
        """Let a marker die or come back."""
        self.world.led_alive[marker] = alive

    def dim_led(self, marker: int, factor: float) -> None:
        """Let a marker emit `factor` times its nominal power."""
        self.world.led_factor[marker] = factor

    def see(self, **changes: Any) -> None:
        """Change what stands between scene and image: fields of `Seeing` by name."""
        self.world.seeing = replace(self.world.seeing, **changes)

    def move_sun(self, elevation_rad: float, azimuth_rad: float) -> None:
        """Let the sun stand this far from where it stood at the start."""
        light = self.world.config.light
        first = Sun(light.sun_elevation, light.sun_azimuth)
        sun = Sun(first.elevation_rad + elevation_rad, first.azimuth_rad + azimuth_rad)
        self.see(sun=sun, daylight=sun.daylight(exposed_for=first))

    def sun_has_moved(self) -> bool:
        """Whether the sun stands elsewhere than at the start."""
        light, sun = self.world.config.light, self.world.seeing.sun
        return sun is not None and sun != Sun(light.sun_elevation, light.sun_azimuth)

    def position(self) -> Array:
        """Where the rover truly is, in `site`, shape (3,)."""
        return self.world.body.pose()[0]

    def ahead_on_path(self, ahead_m: float, aside_m: float = 0.0) -> Vec2:
        """The point of the planned path this far ahead of where the rover truly is, in `site`."""
        x, y, _ = self.position()
        return ahead_on(self.world.route, (float(x), float(y)), ahead_m, aside_m)

    def soil_at(self, at_site_m: Vec2) -> Soil:
        """The soil at a point."""
        return self.world.soils.at(*at_site_m)

    def add_soil(self, patch: Patch) -> None:
        """Lay a patch of other soil over everything so far."""
        self.world.soils.patches.append(patch)
        self.world.wake()

    def remove_soil(self, patch: Patch) -> None:
        """Take that patch away again; ValueError if it is not there."""
        self.world.soils.patches.remove(patch)
        self.world.wake()

    def add_obstacle(self, x_m: float, y_m: float, radius_m: float, height_m: float = 0.0) -> Rock:
        """Put a rock into the way, its centre `height_m` above the ground."""
        return self.add_rock(obstacle(self.world.terrain, x_m, y_m, radius_m, height_m))

    def add_rock(self, rock: Rock) -> Rock:
        """Put a rock exactly where it says."""
        self.world.rocks.add(rock)
        self.world.wake()
        return rock

    def move_rock(self, rock: Rock, x_m: float, y_m: float, z_m: float) -> Rock:
        """Let a rock's centre be elsewhere; the rock as it is then."""
        moved = Rock((x_m, y_m, z_m), rock.radius_m)
        self.world.rocks.move(rock, moved)
        self.world.wake()
        return moved

    def remove_rock(self, rock: Rock) -> None:
        """Take a rock away; ValueError if it is not there."""
        self.world.rocks.remove(rock)
        self.world.wake()

    def touches_rover(self, rock: Rock) -> bool:
        """Whether the rover is in contact with a rock."""
        return self.world.rocks.touches(rock, self.world.body.id)

    def hides(self, ball: Rock, markers: tuple[int, ...] = (0, 1, 2, 3)) -> bool:
        """Whether a rock, or anything else round, hides one of these markers from either camera."""
        scene, rig = self.world.scene(), self.world.rig
        T = scene.T_site_plc
        places = [T[:3, :3] @ np.array(rig.markers.positions_plc_m[m]) + T[:3, 3] for m in markers]
        eyes = [view.position_site_m for view in scene_views(rig, scene)]
        return any(rock_blocks(ball, place, eye) for place in places for eye in eyes)

    def screens(self) -> tuple[Rock, ...]:
        """What hangs in the way of light near the cabin, as balls in `site`."""
        return screens(self.world.scene())

    def towards_head(self, marker: int) -> Vec3:
        """Unit vector from a marker to the middle between the cameras, in `plc`."""
        scene, rig = self.world.scene(), self.world.rig
        T = scene.T_site_plc
        middle = np.mean([view.position_site_m for view in scene_views(rig, scene)], axis=0)
        toward = T[:3, :3].T @ (middle - T[:3, 3]) - np.array(rig.markers.positions_plc_m[marker])
        x, y, z = (float(v) for v in toward / np.linalg.norm(toward))
        return x, y, z

    def on_the_tether(self, behind_m: float) -> Vec3:
        """The point of the ground under the tether this far from the rover, half way if that is nearer."""
        anchor = self.world.anchor()
        to_spool = self.world.tether.spool_site_m - anchor
        share = min(behind_m / float(np.linalg.norm(to_spool)), 0.5)
        x, y, _ = (float(v) for v in anchor + share * to_spool)
        return x, y, self.world.terrain.height(x, y)
