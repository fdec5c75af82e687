"""The world in motion: one tick of mission time at a time, quasi-static, asleep while nothing moves.

Mission time runs `time_scale` times faster than Bullet's. At 1.4 mm/s inertia is nothing, so the path
does not depend on the scale (tests/sim_pybullet/test_physics.py holds the bound).
"""

from __future__ import annotations

import numpy as np

from executive.core.chance import generator
from executive.core.clock import Clock
from executive.core.rig import RigCalibration
from executive.core.types import Array, Segment
from sim_pybullet.bullet import pybullet
from sim_pybullet.cabin import SimCabin
from sim_pybullet.config import WorldConfig
from sim_pybullet.ground_body import add_lander, add_terrain
from sim_pybullet.head import SimHead
from sim_pybullet.inclinometer import SimInclinometer
from sim_pybullet.poses import CabinChain, cabin_chain
from sim_pybullet.rock_pile import RockPile
from sim_pybullet.rover import Grip, PlaneRate, RoverBody
from sim_pybullet.scene import SceneState
from sim_pybullet.seeing import CLEAR
from sim_pybullet.shape import TETHER_ANCHOR_BODY_M, belt
from sim_pybullet.site import make_rocks, make_soils, make_terrain, start_pose
from sim_pybullet.soil import traction_limit
from sim_pybullet.terrain import area_of
from sim_pybullet.tether import SimTether
from sim_pybullet.tracks import SimTracks
from sim_pybullet.traction import Displacement, Load, TrackGround, displacement
from sim_pybullet.truth import TruthSample, TruthSink

STEP_S = 1 / 60
CABIN_SCALE = 6.0  # the cabin is nearly half the mass: faster swings would throw the rover about
SETTLED_M_S, SETTLED_RAD_S = 2e-4, 2e-3
SETTLED_STEPS = 10
LONGEST_SETTLING_STEPS = 240
PHYSICS_MARGIN_M = 1.2  # how much ground beyond the off-track margins is solid
SPOOL_HEIGHT_M = 0.3
TRUTH_EVERY_S = 60.0
DRAGGED_M = 0.001  # a rover that sways less after a stop is not being dragged
LEAST_GRIP = 0.02  # of the weight: even with its belly on a rock some grouser drags
STILL = PlaneRate()


class World:
    """Everything simulated but the cameras. `never_sleep` steps the physics even at rest, for tests."""

    def __init__(
        self,
        config: WorldConfig,
        route: tuple[Segment, ...],
        seed: int,
        rig: RigCalibration,
        clock: Clock,
        truth: TruthSink = lambda sample: None,
        never_sleep: bool = False,
    ) -> None:
        self.config, self.rig, self.clock, self.route = config, rig, clock, route
        self._truth, self._never_sleep = truth, never_sleep
        self.terrain = make_terrain(config.terrain, route, seed)
        self.soils = make_soils(config, seed)
        rocks = make_rocks(config, self.terrain, route, rig, seed)
        self.led_alive, self.led_factor = [True] * 4, [1.0] * 4
        self.seeing = CLEAR
        self.extra_slip, self.side_drift = 0.0, 0.0  # shares of all travel, besides what the ground takes
        self.steps = 0
        self._client = _connect(config.gravity)
        area = area_of(route, PHYSICS_MARGIN_M)
        add_terrain(self._client, self.terrain.crop(area.low_site_m, area.high_site_m))
        self.lander = add_lander(self._client)
        self.rocks = RockPile(self._client, rocks)
        self.body = RoverBody(self._client, rig, *start_pose(config, self.terrain, route, rig, seed))
        mass_kg = rig.rover.rover_mass_kg + rig.rover.payload_mass_kg
        self.weight_n = mass_kg * config.gravity
        self.tracks = SimTracks(rig.rover, self.weight_n, clock, generator(seed, "tracks"))
        self.head = SimHead(rig.head, clock, generator(seed, "head"))
        self.cabin = SimCabin(rig.cabin, clock, generator(seed, "cabin"), self.body.cabin_angles)
        self.inclinometer = SimInclinometer(
            rig.rover.inclinometer_sigma_rad,
            clock,
            generator(seed, "inclinometer"),
            lambda: self.body.pose()[1],
        )
        self._contact_m = belt(rig).length_m
        self._slips = (0.0, 0.0)
        self._grip = Grip(self.weight_n, self.weight_n)
        self._pull = np.zeros(3)
        self._asleep, self._calm_steps, self._restless_steps = False, 0, 0
        self._last_truth_s = -TRUTH_EVERY_S
        self._frames: CabinChain | None = None
        self._settle_down()
        self.tether = SimTether(
            (0.0, 0.0, SPOOL_HEIGHT_M),
            rig.rover.tether_length_m,
            self.anchor(),
            clock,
            generator(seed, "tether"),
        )
        self._write_truth(force=True)

    def wake(self) -> None:
        """Let the physics run until everything is at rest again."""
        self._asleep, self._calm_steps, self._restless_steps = False, 0, 0

    def advance(self) -> None:
        """Let one tick pass: motors, physics, clock, and what that ends."""
        tick_s = self.clock.tick_s
        moving = self.tracks.turning or self.cabin.moving
        awake = moving or not self._asleep
        if awake and self.clock.now_s > self._last_truth_s:
            self._write_truth(force=True)  # the last moment at rest, so that nobody interpolates across it
        self.head.advance(tick_s)
        self.cabin.advance(tick_s)
        forces_n = (0.0, 0.0)
        if moving or not self._asleep or self._never_sleep:
            forces_n = self._move(self.tracks.turn(tick_s), tick_s)
        self.clock.advance()
        self.tracks.feel(forces_n, tick_s)
        self.cabin.settle()
        self.head.settle()
        if not (self.tracks.turning or self.cabin.moving or self._asleep or self._never_sleep):
            self._settle_down()  # what sways after a stop is the time scale's inertia, not the rover's
        self._write_truth(force=awake)

    def _move(self, belts_m: tuple[float, float], tick_s: float) -> tuple[float, float]:
        """One tick of physics; what the belts pull with at its end [N]."""
        self._frames = None
        moved = self._displacement(belts_m)
        if belts_m != (0.0, 0.0) or self.cabin.moving:
            self.wake()
        scale = min(self.config.time_scale, CABIN_SCALE) if self.cabin.moving else self.config.time_scale
        count = max(1, round(tick_s / scale / STEP_S))
        rate = _plane_rate(moved, self.body.pose()[1], count * STEP_S)
        self.body.hold_cabin(*self.cabin.targets_rad)
        self._pull = self.tether.pull(self.anchor())
        for _ in range(count):
            self._step(rate)
        return self.body.traction()

    def _displacement(self, belts_m: tuple[float, float]) -> Displacement:
        """What the soil makes of the belts' travel, at the place and attitude where the rover is now."""
        position, rotation = self.body.pose()
        load = Load.of(rotation, self.weight_n, self._pull)
        left, right = (self._ground(position + rotation[:, 1] * side) for side in self._sides())
        self._grip = self._gripping((left, right))
        soil = self.soils.at(float(position[0]), float(position[1]))
        efficiency = self.soils.yaw_efficiency(soil, float(position[0]), float(position[1]))
        slip_left, slip_right = (
            1.0 - g.travel(b, load) / b if b != 0.0 else 0.0
            for g, b in zip((left, right), belts_m, strict=True)
        )
        self._slips = slip_left, slip_right
        gauge_m = self.rig.rover.track_gauge_m
        return displacement(belts_m, (left, right), load, efficiency, gauge_m, self.side_drift)

    def _gripping(self, grounds: tuple[TrackGround, TrackGround]) -> Grip:
        """What the tracks can push with under the load that they bear now; less where the belly bears some.

        The servos push horizontally and take the ground's normal force as it is, hence the cosine: the rover
        must slide where the tangent of the slope, not its sine, exceeds the friction.
        """
        level = float(self.body.pose()[1][2, 2])
        limits_n = (traction_limit(g.soil, n) for g, n in zip(grounds, self.body.loads(), strict=True))
        force_n = max(sum(limits_n) * level, LEAST_GRIP * self.weight_n)
        return Grip(force_n, force_n * self.rig.rover.track_gauge_m / 2)

    def _sides(self) -> tuple[float, float]:
        half_m = self.rig.rover.track_gauge_m / 2
        return half_m, -half_m

    def _ground(self, at_site_m: Array) -> TrackGround:
        x, y = float(at_site_m[0]), float(at_site_m[1])
        soil = self.soils.at(x, y)
        lost = self.soils.slip_scatter(soil, x, y) + self.extra_slip + soil.sinkage
        return TrackGround(soil, min(lost, 1.0), self._contact_m)

    def _step(self, rate: PlaneRate) -> None:
        self.body.command(rate, self._grip, STEP_S)
        if self._pull.any():
            x, y, z = self._pull
            self.body.push((float(x), float(y), float(z)), self.anchor())
        pybullet.stepSimulation(physicsClientId=self._client)
        self.steps += 1
        self._doze()

    def _doze(self) -> None:
        """Fall asleep after some calm steps, or where a contact keeps trembling for very long."""
        linear, angular = self.body.speeds()
        calm = linear < SETTLED_M_S and angular < SETTLED_RAD_S
        self._calm_steps = self._calm_steps + 1 if calm else 0
        self._restless_steps += 1
        if self._calm_steps >= SETTLED_STEPS or self._restless_steps >= LONGEST_SETTLING_STEPS:
            self._asleep = True

    def _settle_down(self) -> None:
        """Step until all is at rest; a tether that drags the rover along slackens with that."""
        pulled_at_m = self.anchor() if self._pull.any() else None
        while not self._asleep:
            self._step(STILL)
            if pulled_at_m is not None and np.linalg.norm(self.anchor() - pulled_at_m) > DRAGGED_M:
                pulled_at_m = self.anchor()
                self._pull = self.tether.pull(pulled_at_m)

    def anchor(self) -> Array:
        """Where the tether is tied to the rover, in `site`."""
        position, rotation = self.body.pose()
        anchor: Array = position + rotation @ np.array(TETHER_ANCHOR_BODY_M)
        return anchor

    def scene(self) -> SceneState:
        """What there is to see now. The rover's frames are worked out anew only after it may have moved."""
        if self._frames is None:
            arm_rad, cabin_rad = self.body.cabin_angles()
            self._frames = cabin_chain(self.rig.cabin, *self.body.pose(), arm_rad, cabin_rad)
        chain = self._frames
        pan_rad, tilt_rad = self.head.true_rad
        a, b, c, d = self.led_alive
        fa, fb, fc, fd = self.led_factor
        return SceneState(
            time_s=self.clock.now_s,
            T_site_body=chain.body,
            T_site_arm=chain.arm,
            T_site_cabin=chain.cabin,
            T_site_plc=chain.plc,
            arm_rad=chain.arm_rad,
            cabin_rad=chain.cabin_rad,
            head_pan_rad=pan_rad,
            head_tilt_rad=tilt_rad,
            rocks=tuple(self.rocks),
            led_alive=(a, b, c, d),
            led_factor=(fa, fb, fc, fd),
            seeing=self.seeing,
        )

    def _write_truth(self, force: bool) -> None:
        """Every tick in motion; at rest now and then."""
        if not force and self.clock.now_s - self._last_truth_s < TRUTH_EVERY_S:
            return
        self._last_truth_s = self.clock.now_s
        position, _ = self.body.pose()
        arm_rad, cabin_rad = self.body.cabin_angles()
        pan_rad, tilt_rad = self.head.true_rad
        x, y, z = position
        self._truth(
            TruthSample(
                self.clock.now_s,
                (float(x), float(y), float(z)),
                self.body.quat(),
                pan_rad,
                tilt_rad,
                arm_rad,
                cabin_rad,
                self._slips[0],
                self._slips[1],
                self.tether.length_m,
                self.tether.tension_n,
                self.tracks.turning,
            )
        )

    def close(self) -> None:
        """Release the physics client; may be called twice."""
        if self._client >= 0:
            pybullet.disconnect(physicsClientId=self._client)
            self._client = -1


def _connect(gravity_m_s2: float) -> int:
    client = int(pybullet.connect(pybullet.DIRECT))
    pybullet.setGravity(0.0, 0.0, -gravity_m_s2, physicsClientId=client)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=STEP_S,
        enableConeFriction=1,  # the default pyramid holds 40 % more at 45 degrees to the axes
        deterministicOverlappingPairs=1,
        contactBreakingThreshold=0.001,  # with Bullet's 20 mm the rover rocks on stale contacts for ever
        physicsClientId=client,
    )
    return client


def _plane_rate(moved: Displacement, rotation: Array, lasts_s: float) -> PlaneRate:
    """A displacement in the body's axes as motion of the anchor in the site's plane."""
    x_m, y_m = moved.ahead_m * rotation[:2, 0] + moved.left_m * rotation[:2, 1]
    return PlaneRate(
        float(x_m) / lasts_s, float(y_m) / lasts_s, moved.turn_rad * float(rotation[2, 2]) / lasts_s
    )
