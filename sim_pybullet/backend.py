"""The simulation as a backend: a world, its devices, its cameras, and the one thing that lets time pass."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

from executive.config.backends import BackendRequest
from executive.core.chance import generator
from executive.core.clock import Clock, Stopwatch
from executive.core.devices import CABIN, CAMERAS, HEAD, INCLINOMETER, LINK, TETHER, TRACKS
from executive.core.errors import LongarmError
from executive.core.ports import Cameras, Devices
from executive.core.rig import RigCalibration
from executive.core.types import Point, Segment
from sim_pybullet.cameras import make_cameras
from sim_pybullet.config import WorldConfig
from sim_pybullet.exposing import ExposureLog
from sim_pybullet.link import SimLink
from sim_pybullet.sunlight import Sun
from sim_pybullet.terrain import area_of
from sim_pybullet.truth import TruthFile
from sim_pybullet.world import World
from sim_pybullet.world_faults import WorldFaults

MAP_MARGIN_M = 1.0


class TickedCameras(Cameras, Protocol):
    """Cameras that expose as time passes."""

    log: ExposureLog

    def tick(self) -> None:
        """Expose what is due now; called once after each tick of time."""
        ...


CameraMaker = Callable[[World, Clock, RigCalibration, Stopwatch], TickedCameras]


class SimBackend:
    """A rover in PyBullet behind the ports. Nothing of the truth leads out but through `truth.mcap`."""

    def __init__(self, request: BackendRequest, make: CameraMaker) -> None:
        if not isinstance(request.world, WorldConfig):
            raise LongarmError(f"got a world of type {type(request.world).__name__}, expected a WorldConfig")
        if not isinstance(request.rig, RigCalibration):
            raise LongarmError(f"got a rig of type {type(request.rig).__name__}, expected a RigCalibration")
        self.rig = _rig_of(request.rig, request.world)
        self.clock = Clock(request.tick_s)
        self._watch = Stopwatch()
        self._truth = TruthFile(request.truth_path)
        try:
            self._make(request, request.world, make)
        except BaseException:  # also a signal: who makes a backend cannot close one that was never made
            self._truth.close()
            raise

    def _make(self, request: BackendRequest, world: WorldConfig, make: CameraMaker) -> None:
        with self._watch.measure("physics"):
            self.world = World(world, request.route, request.seed, self.rig, self.clock, self._truth.write)
        near = area_of((*request.route, _from_lander(request.route)), MAP_MARGIN_M)
        self._truth.ground(self.world.terrain.crop(near.low_site_m, near.high_site_m), self.world.rocks)
        self._cameras = make(self.world, self.clock, self.rig, self._watch)
        self._link = SimLink(self.clock)
        self.world_faults = WorldFaults(self.world, self._cameras.log)
        self.devices = Devices(
            TRACKS.fit(self.world.tracks),
            CABIN.fit(self.world.cabin),
            HEAD.fit(self.world.head),
            CAMERAS.fit(self._cameras),
            INCLINOMETER.fit(self.world.inclinometer),
            TETHER.fit(self.world.tether),
            LINK.fit(self._link),
        )

    def advance(self) -> None:
        """Let one tick of mission time pass."""
        with self._watch.measure("physics"):
            self.world.advance()
        self._link.settle()
        with self._watch.measure("render"):
            self._cameras.tick()
        self._truth.flush()

    def safe_stop(self) -> None:
        """Bring the rover, its cabin and the head to rest."""
        self.world.tracks.stop()
        self.world.cabin.stop()
        self.world.head.stop()

    def wall_s(self) -> Mapping[str, float]:
        """Wall time spent on physics and on rendering [s]."""
        return dict(self._watch.spent_s)

    def close(self) -> None:
        """Release the physics and close the truth; may be called twice."""
        self.world.close()
        self._truth.close()


def _from_lander(route: tuple[Segment, ...]) -> Segment:
    """A line from the lander to the first way-point, so that the map shows both."""
    return replace(route[0], start=Point(0.0, 0.0), end=route[0].start)


def _rig_of(rig: RigCalibration, world: WorldConfig) -> RigCalibration:
    """The rig with the mast as high as this world says, if it says."""
    if world.mast_height is None:
        return rig
    return replace(rig, head=replace(rig.head, mast_height_m=world.mast_height))


def create(request: BackendRequest) -> SimBackend:
    """The backend with the cameras of the asked tier."""

    def cameras(world: World, clock: Clock, rig: RigCalibration, watch: Stopwatch) -> TickedCameras:
        light = world.config.light
        return make_cameras(
            request.tier,
            rig,
            clock,
            world.scene,
            world.head.read,
            world.terrain,
            Sun(light.sun_elevation, light.sun_azimuth),
            generator(request.seed, "cameras"),
            watch,
        )

    return SimBackend(request, cameras)
