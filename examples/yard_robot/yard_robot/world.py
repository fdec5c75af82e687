"""The yard in motion: one tick of mission time at a time, asleep while nothing moves."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from executive.core.chance import generator
from executive.core.clock import Clock
from executive.core.types import TiltReading, Window
from longarm import Segment

from yard_robot.actions import PerTick
from yard_robot.battery import Battery
from yard_robot.bullet import pybullet
from yard_robot.config import YardConfig
from yard_robot.eye import SimEye
from yard_robot.ground import Ground, area_of
from yard_robot.husky import HuskyBody, Pair
from yard_robot.marker_box import FACES
from yard_robot.marker_pose import cosine
from yard_robot.model import HuskyModel
from yard_robot.pole_camera import Image, draw
from yard_robot.rig import YardRig
from yard_robot.wheels import IDLE_A, ROLLING_A, SCRUBBING_A, Wheels

STEP_S = 1 / 20
_CALM_M_S = 1e-3
_LONGEST_SETTLING_STEPS = 60
_SPIN_SAVES = 0.7  # of a tread's load, where it spins freely
_TILT_SIGMA_RAD = math.radians(0.2)
_VOLTS = 24.0


class World:
    """Everything simulated. What faults change is public: slip, iris, faces covered, the leak."""

    def __init__(
        self, config: YardConfig, route: tuple[Segment, ...], seed: int, rig: YardRig, clock: Clock
    ) -> None:
        self.config, self.rig, self.clock = config, rig, clock
        self.battery = Battery(config.battery)
        self.light = config.light
        self.iris = 1.0
        """Share of the light that reaches the camera's sensor."""
        self.lost_m = 0.0
        """Travel that `slip` has lost so far, the mean of both sides."""
        self.slip: Pair = (0.0, 0.0)
        """Share of the treads' travel that is lost on the ground, left and right."""
        self.area_m = area_of(route)
        self.ground = Ground(config.ground, route, generator(seed, "ground"))
        self._client = _connect(config.gravity)
        self.body = HuskyBody(self._client, rig.rover, *_start(config, route, generator(seed, "start")))
        self.model = HuskyModel(rig.rover, rig.box)
        self._counted_m: Pair = (0.0, 0.0)
        self.wheels = Wheels(clock, generator(seed, "wheels"), lambda: self._counted_m)
        tilt_rng, picture_rng = generator(seed, "inclinometer"), generator(seed, "camera")
        self.gauge = PerTick(lambda: self.battery.read(clock.now_s), lambda: clock.ticks)
        self.inclinometer = PerTick(lambda: self._tilt(tilt_rng), lambda: clock.ticks)
        self.eye = SimEye(clock, rig.camera.exposure_s, self._drawer(picture_rng))
        self._asleep, self._rested = False, True
        self._settle_down()

    def advance(self) -> None:
        """Let one tick pass."""
        tick_s = self.clock.tick_s
        self._rested = not self.wheels.turning
        loads_a = [(IDLE_A, IDLE_A)]
        if self.wheels.turning:
            loads_a = [self._drive(self.wheels.speeds(STEP_S)) for _ in range(round(tick_s / STEP_S))]
        self.clock.advance()
        left_a, right_a = np.mean(loads_a, axis=0).tolist()
        self.wheels.load_a = left_a, right_a
        if self.battery.charge <= 0.0:
            self.wheels.fail("no power")
        self.wheels.settle()
        self.battery.pass_time(tick_s, _VOLTS * (left_a + right_a), self.light)
        if not self.wheels.turning:
            self._settle_down()

    def faces_seen(self) -> tuple[str, ...]:
        """The faces of the box of markers that are turned towards the camera."""
        position, rotation = self.body.pose()
        return tuple(f for f in FACES if cosine(self.rig.camera, self.rig.box, position, rotation, f) > 0.0)

    @property
    def resting(self) -> bool:
        """Whether nothing moves, nor did in the last tick."""
        return self._rested

    def _drive(self, treads_m_s: Pair) -> Pair:
        """One step with the encoders counting at these speeds; what each side draws [A]."""
        self._asleep = False
        (x, y, _), _ = self.body.pose()
        here = self.ground.slip(float(x), float(y))
        slips = tuple(1.0 - (1.0 - here) * (1.0 - own) for own in self.slip)
        left, right = (v * (1.0 - slip) for v, slip in zip(treads_m_s, slips, strict=True))
        turn_rad_s = self.ground.turning(float(x), float(y)) * (right - left) / self.rig.rover.track_gauge_m
        self.body.move((left + right) / 2, turn_rad_s, treads_m_s)
        pybullet.stepSimulation(physicsClientId=self._client)
        self.lost_m += STEP_S * sum(abs(v) * own for v, own in zip(treads_m_s, self.slip, strict=True)) / 2
        counted = [c + v * STEP_S for c, v in zip(self._counted_m, treads_m_s, strict=True)]
        self._counted_m = counted[0], counted[1]
        scrub = abs(right - left) / (abs(right) + abs(left) + 1e-9)
        full = self.rig.rover.speed_m_s
        loads = [
            IDLE_A + (ROLLING_A + SCRUBBING_A * scrub) * abs(v) / full * (1.0 - _SPIN_SAVES * slip)
            for v, slip in zip(treads_m_s, slips, strict=True)
        ]
        return loads[0], loads[1]

    def _settle_down(self) -> None:
        """Step until all is at rest, within the present moment."""
        for _ in range(_LONGEST_SETTLING_STEPS):
            if self._asleep:
                return
            self.body.move(0.0, 0.0, (0.0, 0.0))
            pybullet.stepSimulation(physicsClientId=self._client)
            self._asleep = self.body.speed_m_s() < _CALM_M_S
        self._asleep = True

    def _tilt(self, rng: np.random.Generator) -> TiltReading:
        _, rotation = self.body.pose()
        roll = math.atan2(rotation[2, 1], rotation[2, 2])
        pitch = -math.asin(max(-1.0, min(1.0, rotation[2, 0])))
        noise = rng.normal(0.0, _TILT_SIGMA_RAD, 2)
        return TiltReading(self.clock.now_s, roll + float(noise[0]), pitch + float(noise[1]))

    def _drawer(self, rng: np.random.Generator) -> Callable[[Window], Image]:
        def drawn(window: Window) -> Image:
            self.model.put(*self.body.placed())
            return draw(self.model.client, self.rig.camera, window, self.light * self.iris, rng)

        return drawn

    def close(self) -> None:
        """Release physics and scene; may be called twice."""
        self.model.close()
        if self._client >= 0:
            pybullet.disconnect(physicsClientId=self._client)
            self._client = -1


def _connect(gravity_m_s2: float) -> int:
    client = int(pybullet.connect(pybullet.DIRECT))
    pybullet.setGravity(0.0, 0.0, -gravity_m_s2, physicsClientId=client)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=STEP_S, enableConeFriction=1, deterministicOverlappingPairs=1, physicsClientId=client
    )
    ground = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    pybullet.createMultiBody(baseCollisionShapeIndex=ground, physicsClientId=client)
    return client


def _start(config: YardConfig, route: tuple[Segment, ...], rng: np.random.Generator) -> tuple[Pair, float]:
    """Where the robot stands: near the first way-point, facing away from the pole."""
    first = route[0].start
    dx, dy, turn = rng.normal(0.0, 1.0, 3).tolist()
    place = config.start.place
    heading = math.atan2(first.y_m, first.x_m) + config.start.heading * turn
    return (first.x_m + place * dx, first.y_m + place * dy), heading
