"""The handle through which faults act on the world itself; each change takes effect at once."""

from __future__ import annotations

from executive.types import Vec2
from sim_pybullet.path import ahead_on
from sim_pybullet.rocks import obstacle
from sim_pybullet.scene import Rock
from sim_pybullet.soil import Patch
from sim_pybullet.world import World


class WorldFaults:
    """Alters a world; no port leads here. Markers count from 0, sides are 0 left and 1 right."""

    def __init__(self, world: World) -> None:
        self._world = world

    def set_led(self, marker: int, alive: bool) -> None:
        """Let a marker die or come back."""
        self._world.led_alive[marker] = alive

    def dim_led(self, marker: int, factor: float) -> None:
        """Let a marker emit `factor` times its nominal power."""
        self._world.led_factor[marker] = factor

    def set_track_factor(self, side: int, factor: float) -> None:
        """Let a motor turn `factor` times as fast as commanded."""
        self._world.tracks.speed_factors[side] = factor

    def set_slip(self, slip: float) -> None:
        """Let this share of all belt travel be lost, on top of what the ground takes."""
        self._world.extra_slip = slip

    def ahead_on_path(self, ahead_m: float, aside_m: float = 0.0) -> Vec2:
        """The point of the planned path this far ahead of where the rover truly is, in `site`."""
        position, _ = self._world.body.pose()
        return ahead_on(self._world.route, (float(position[0]), float(position[1])), ahead_m, aside_m)

    def add_soil(self, patch: Patch) -> None:
        """Lay a patch of other soil over everything so far."""
        self._world.soils.patches.append(patch)
        self._world.wake()

    def remove_soil(self, patch: Patch) -> None:
        """Take that patch away again; ValueError if it is not there."""
        self._world.soils.patches.remove(patch)
        self._world.wake()

    def add_obstacle(self, x_m: float, y_m: float, radius_m: float, height_m: float = 0.0) -> Rock:
        """Put a rock into the way, its centre `height_m` above the ground."""
        rock = obstacle(self._world.terrain, x_m, y_m, radius_m, height_m)
        self._world.add_rock(rock)
        return rock

    def jam_tether(self, jammed: bool) -> None:
        """Stop the spool, or let it turn again."""
        self._world.tether.jammed = jammed
        self._world.wake()
