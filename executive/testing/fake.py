"""A robot of a page: arithmetic instead of physics, an overhead view instead of cameras.

The rover moves as the belts say, times a constant advance and yaw efficiency; the overhead camera
returns marker centres at 1000 px per metre, from which `OverheadLocalizer` fits the pose. Deterministic.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Generic, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict

from executive.config.backends import BackendRequest, BackendSpec
from executive.config.localizers import LocalizerRequest, LocalizerSpec
from executive.core.clock import Clock
from executive.core.devices import CABIN, CAMERAS, HEAD, INCLINOMETER, LINK, TETHER, TRACKS
from executive.core.ports import Action, Devices, LocaliseRequest
from executive.core.rig import RigCalibration
from executive.core.types import (
    CabinReading,
    Call,
    Centres,
    HeadReading,
    Images,
    Localisation,
    Outcome,
    PoseEstimate,
    PoseSource,
    Quality,
    Reason,
    Shot,
    TetherReading,
    TiltReading,
    TrackReading,
    Vec2,
)
from executive.isc.attitude import quat_from_heading_tilt

T = TypeVar("T")
PIXELS_PER_M = 1000.0
ALL = ("tracks", "cabin", "head", "cameras", "inclinometer", "tether", "link")


class FakeWorld(BaseModel):
    """How the fake robot moves and is seen."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    advance: float = 0.95
    yaw_efficiency: float = 0.6
    pixel_sigma: float = 0.5
    drive_current_a: float = 0.12


@dataclass
class TimedAction(Generic[T]):
    """Ends after a number of ticks with what `finish` then says; `progress` is called every tick."""

    ticks_left: int
    finish: Callable[[], Outcome[T]]
    progress: Callable[[], None] = lambda: None
    outcome: Outcome[T] | None = None

    def poll(self) -> Outcome[T] | None:
        return self.outcome

    def cancel(self) -> None:
        self.outcome = self.outcome or Outcome(Reason.CANCELLED)

    def tick(self) -> None:
        if self.outcome is None:
            self.progress()
            self.ticks_left -= 1
            if self.ticks_left <= 0:
                self.outcome = self.finish()


@dataclass
class FakeRobot:
    """The state, and every port at once; `devices()` sorts them."""

    clock: Clock
    rig: RigCalibration
    world: FakeWorld
    rng: np.random.Generator
    x_m: float
    y_m: float
    heading_rad: float
    left_m: float = 0.0
    right_m: float = 0.0
    moving: bool = False
    arm_rad: float = 0.0
    cabin_rad: float = 0.0
    pan_rad: float = 0.0
    tilt_rad: float = 0.0
    under_way: list[TimedAction[Any]] = field(default_factory=list)
    driving: TimedAction[TrackReading] | None = None

    def tick(self) -> None:
        for action in list(self.under_way):
            action.tick()
        self.under_way = [a for a in self.under_way if a.outcome is None]

    def start(self, action: TimedAction[T]) -> TimedAction[T]:
        self.under_way.append(action)
        return action

    def move(self, left_m: float, right_m: float) -> None:
        self.left_m += left_m
        self.right_m += right_m
        forward = self.world.advance * (left_m + right_m) / 2
        turn = self.world.yaw_efficiency * (right_m - left_m) / self.rig.rover.track_gauge_m
        middle = self.heading_rad + turn / 2
        self.x_m += forward * math.cos(middle)
        self.y_m += forward * math.sin(middle)
        self.heading_rad += turn

    def rest(self) -> None:
        self.moving = False
        if self.driving is not None:
            self.driving.cancel()


@dataclass
class FakeTracks:
    robot: FakeRobot

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        self.stop()
        robot = self.robot
        ticks = max(1, robot.clock.ticks_for(max(abs(left_m), abs(right_m)) / speed_m_s))
        robot.moving = True

        def finish() -> Outcome[TrackReading]:
            robot.moving = False
            return Outcome(Reason.DONE, value=self.read())

        action = TimedAction(ticks, finish, lambda: robot.move(left_m / ticks, right_m / ticks))
        robot.driving = robot.start(action)
        return action

    def stop(self) -> None:
        self.robot.rest()

    def read(self) -> TrackReading:
        robot = self.robot
        current = robot.world.drive_current_a if robot.moving else 0.02
        return TrackReading(robot.clock.now_s, robot.left_m, robot.right_m, current, current, robot.moving)


@dataclass
class FakeCabin:
    robot: FakeRobot

    def move(self, arm_rad: float, cabin_rad: float) -> Action[CabinReading]:
        robot, limits = self.robot, self.robot.rig.cabin
        inside = _within(arm_rad, limits.arm_limits_rad) and _within(cabin_rad, limits.cabin_limits_rad)
        if not inside:
            return TimedAction(0, lambda: Outcome(Reason.OUT_OF_REACH), outcome=Outcome(Reason.OUT_OF_REACH))

        def finish() -> Outcome[CabinReading]:
            robot.arm_rad, robot.cabin_rad = arm_rad, cabin_rad
            return Outcome(Reason.DONE, value=self.read())

        return robot.start(TimedAction(2, finish))

    def read(self) -> CabinReading:
        return CabinReading(self.robot.clock.now_s, self.robot.arm_rad, self.robot.cabin_rad, moving=False)


@dataclass
class FakeHead:
    robot: FakeRobot

    def point(self, pan_rad: float, tilt_rad: float) -> Action[HeadReading]:
        robot, limits = self.robot, self.robot.rig.head
        if abs(pan_rad) > limits.pan_limit_rad or not _within(tilt_rad, limits.tilt_limits_rad):
            return TimedAction(0, lambda: Outcome(Reason.OUT_OF_REACH), outcome=Outcome(Reason.OUT_OF_REACH))

        def finish() -> Outcome[HeadReading]:
            robot.pan_rad, robot.tilt_rad = pan_rad, tilt_rad
            return Outcome(Reason.DONE, value=self.read())

        return robot.start(TimedAction(2, finish))

    def read(self) -> HeadReading:
        return HeadReading(self.robot.clock.now_s, self.robot.pan_rad, self.robot.tilt_rad, moving=False)


@dataclass
class FakeCameras:
    robot: FakeRobot

    def take(self, shot: Shot) -> Action[Images | Centres]:
        ticks = max(1, self.robot.clock.ticks_for(len(shot.leds) * shot.cadence_s))
        return self.robot.start(TimedAction(ticks, lambda: Outcome(Reason.DONE, value=self._look(shot))))

    def _look(self, shot: Shot) -> Images | Centres:
        robot = self.robot
        c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
        plan = np.array([(x, y) for x, y, _ in robot.rig.markers.positions_plc_m])
        seen = plan @ np.array([[c, s], [-s, c]]) + (robot.x_m, robot.y_m)
        noise = robot.rng.normal(0.0, robot.world.pixel_sigma, (2, len(plan), 2))
        sigma = np.full((2, len(plan)), max(robot.world.pixel_sigma, 1e-3))
        return Centres(robot.clock.now_s, shot, PIXELS_PER_M * seen + noise, sigma, FakeHead(robot).read())


@dataclass
class FakeInclinometer:
    robot: FakeRobot

    def read(self) -> TiltReading:
        return TiltReading(self.robot.clock.now_s, 0.0, 0.0)


@dataclass
class FakeTether:
    robot: FakeRobot

    def read(self) -> TetherReading:
        return TetherReading(self.robot.clock.now_s, math.hypot(self.robot.x_m, self.robot.y_m), 0.2)


@dataclass
class FakeLink:
    robot: FakeRobot

    def call(self, call: Call) -> Action[str]:
        return self.robot.start(TimedAction(5, lambda: Outcome(Reason.TIMEOUT, "nobody is on the ground")))


class FakeBackend:
    """The fake robot as a `Backend`, with all its devices or some."""

    def __init__(self, request: BackendRequest, devices: Collection[str] = ALL) -> None:
        world = request.world
        if not isinstance(world, FakeWorld):
            raise TypeError(f"got a {type(world).__name__}, expected a FakeWorld")
        self.clock = Clock(request.tick_s)
        if not isinstance(request.rig, RigCalibration):
            raise TypeError(f"got a {type(request.rig).__name__}, expected a RigCalibration")
        self.rig = request.rig
        first = request.route[0].start
        rng = np.random.default_rng(request.seed)
        radial = math.atan2(first.y_m, first.x_m)
        self.robot = FakeRobot(self.clock, self.rig, world, rng, first.x_m, first.y_m, radial)
        fitted = (
            TRACKS.fit(FakeTracks(self.robot)),
            CABIN.fit(FakeCabin(self.robot)),
            HEAD.fit(FakeHead(self.robot)),
            CAMERAS.fit(FakeCameras(self.robot)),
            INCLINOMETER.fit(FakeInclinometer(self.robot)),
            TETHER.fit(FakeTether(self.robot)),
            LINK.fit(FakeLink(self.robot)),
        )
        self.devices = Devices(*(one for one in fitted if one.spec.name in devices))

    def advance(self) -> None:
        self.clock.advance()
        self.robot.tick()

    def safe_stop(self) -> None:
        self.robot.rest()

    def wall_s(self) -> Mapping[str, float]:
        return {}

    def close(self) -> None:
        return None


class OverheadLocalizer:
    """Fits the pose to the fake robot's overhead view (2-D rigid fit of the marker centres)."""

    def __init__(self, devices: Devices, rig: RigCalibration, clock: Clock) -> None:
        self._devices, self._rig, self._clock = devices, rig, clock

    def locate(self, request: LocaliseRequest) -> Action[Localisation]:
        source = PoseSource.TREND if request.quality is Quality.TREND else OVERHEAD.sources[0]
        return _Located(self._devices[CAMERAS].take(Shot(leds=(0, 1, 2, 4, 8))), self._rig, source)

    def pointing(self, pose: PoseEstimate) -> Vec2:
        height = self._rig.head.mast_height_m
        return math.atan2(pose.y_m, pose.x_m), math.atan2(height, math.hypot(pose.x_m, pose.y_m))


@dataclass
class _Located:
    taking: Action[Images | Centres]
    rig: RigCalibration
    source: str
    outcome: Outcome[Localisation] | None = None

    def poll(self) -> Outcome[Localisation] | None:
        if self.outcome is None:
            self.outcome = self._looked()
        return self.outcome

    def _looked(self) -> Outcome[Localisation] | None:
        outcome = self.taking.poll()
        if outcome is None:
            return None
        if not isinstance(outcome.value, Centres):
            return Outcome(outcome.reason if not outcome.ok else Reason.DEVICE, "no centres")
        if not np.isfinite(outcome.value.uv_px).all():
            return Outcome(Reason.NOT_SEEN, "not every marker is seen")
        return Outcome(Reason.DONE, value=Localisation(self._fit(outcome.value)))

    def cancel(self) -> None:
        self.taking.cancel()

    def _fit(self, centres: Centres) -> PoseEstimate:
        seen = centres.uv_px.mean(axis=0) / PIXELS_PER_M
        plan = np.array([(x, y) for x, y, _ in self.rig.markers.positions_plc_m])
        around = seen - seen.mean(axis=0)
        heading = math.atan2(
            float((plan[:, 0] * around[:, 1] - plan[:, 1] * around[:, 0]).sum()),
            float((plan * around).sum()),
        )
        x, y = seen.mean(axis=0)
        sigma_m = float(centres.sigma_px[0, 0]) / PIXELS_PER_M / math.sqrt(8)
        sigma_rad = sigma_m / float(np.sqrt((plan**2).sum(axis=1).mean()))
        return PoseEstimate(
            time_s=centres.time_s,
            position_site_m=(float(x), float(y), 0.0),
            quat_site_body=quat_from_heading_tilt(heading, 0.0, 0.0),
            covariance=np.diag([sigma_m**2] * 3 + [1e-6, 1e-6, sigma_rad**2]),
            source=self.source,
            markers=len(plan),
        )


def _within(value: float, limits: Vec2) -> bool:
    return limits[0] <= value <= limits[1]


BACKEND = BackendSpec(
    name="fake",
    doc="Arithmetic instead of physics: for tests of trees and strategies, thousands of ticks a second.",
    world_model=FakeWorld,
    tiers=("geometric",),
    devices=ALL,
    rig=RigCalibration,
    create=FakeBackend,
)


def _overhead(request: LocalizerRequest) -> OverheadLocalizer:
    return OverheadLocalizer(request.devices, request.rig, request.clock)


def _markers(rig: RigCalibration) -> int:
    return len(rig.markers.positions_plc_m)


OVERHEAD = LocalizerSpec(
    name="overhead",
    doc="Fits the pose to the fake robot's overhead view, all markers at once.",
    sources=("overhead",),
    make=_overhead,
    tiers=("geometric",),
    needs=("cameras",),
    rig=RigCalibration,
    expected_markers=_markers,
)


def fake_with(*devices: str) -> BackendSpec:
    """The fake robot with these of its devices only."""
    return replace(BACKEND, devices=devices, create=lambda request: FakeBackend(request, devices))
