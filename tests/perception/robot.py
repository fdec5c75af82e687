"""A robot of a page for the localizer's tests: devices that answer with synthetic images of a true state."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from executive.core.clock import Clock
from executive.core.devices import CABIN, CAMERAS, HEAD, INCLINOMETER
from executive.core.ports import Devices
from executive.core.types import (
    CabinReading,
    Centres,
    HeadReading,
    Images,
    Outcome,
    PoseEstimate,
    PoseSource,
    Reason,
    Shot,
    TiltReading,
    Window,
)
from perception.geometry.chain import ChainState
from perception.geometry.pose import roll_pitch
from perception.geometry.rotation import quat_from_matrix
from tests.perception.synthetic import Scene, background_e, marker_electrons, observed, sequence, spot

LEAST_OUTLINE = 3  # frames without an LED, of which the geometric tier makes an outline
PICTURE = (0,)  # of the ground, to watch the head by; this robot's shows none


@dataclass
class After:
    """An action that gives its outcome at a mission time."""

    clock: Clock
    at_s: float
    outcome: Outcome
    cancelled: bool = False

    def poll(self):
        if self.cancelled:
            return Outcome(Reason.CANCELLED)
        return self.outcome if self.clock.now_s >= self.at_s else None

    def cancel(self):
        if self.clock.now_s < self.at_s:
            self.cancelled = True


@dataclass
class Robot:
    """Head, cameras, cabin and inclinometers around a true body pose; everything takes mission time."""

    scene: Scene
    rng: np.random.Generator
    clock: Clock = field(default_factory=Clock)
    geometric: bool = False
    hidden: set[int] = field(default_factory=set)
    swapped: dict[int, int] = field(default_factory=dict)
    brightness: float = 1.0
    light_per_frame: float = 0.0
    outline: bool = True
    shots: list[Shot] = field(default_factory=list)
    pictures: list[Shot] = field(default_factory=list)
    moves: int = 0
    spoil: object = None  # callable on a stack of counts

    def __post_init__(self):
        self.chain = self.scene.chain
        self.state = self.scene.state
        self.head_error = np.zeros(2)
        self.actions: list[After] = []

    @property
    def devices(self) -> Devices:
        return Devices(
            CABIN.fit(self), HEAD.fit(_Head(self)), CAMERAS.fit(self), INCLINOMETER.fit(_Tilt(self))
        )

    def read(self):
        return CabinReading(self.clock.now_s, *self.state.joints_rad, moving=False)

    def head_reading(self):
        return HeadReading(self.clock.now_s, *self.state.head_rad, moving=False)

    def point(self, pan_rad, tilt_rad):
        self.moves += 1
        self.state = ChainState(self.state.site_body, (pan_rad, tilt_rad), self.state.joints_rad)
        accuracy = (self.chain.rig.head.pan_accuracy_rad, self.chain.rig.head.tilt_accuracy_rad)
        self.head_error = self.rng.uniform(-1, 1, 2) * accuracy
        return self._later(3.0, Outcome(Reason.DONE, value=self.head_reading()))

    def take(self, shot: Shot):
        (self.pictures if shot.leds == PICTURE else self.shots).append(shot)
        end = len(shot.leds) * shot.cadence_s
        true = ChainState(
            self.state.site_body,
            tuple(np.array(self.state.head_rad) + self.head_error),
            self.state.joints_rad,
        )
        view = observed(self.chain, true)
        data = self._centres(shot, view, end) if self.geometric else self._images(shot, view, end)
        return self._later(end, Outcome(Reason.DONE, value=data))

    def _later(self, duration_s, outcome):
        action = After(self.clock, self.clock.now_s + duration_s, outcome)
        self.actions.append(action)
        return action

    def _centres(self, shot, view, end):
        uv = view.uv_px + 0.12 * self.rng.standard_normal(view.uv_px.shape)
        inside = self.chain.model.inside(view.uv_px)
        uv = np.where(inside[..., None], uv, np.nan)
        outline = self.outline and len(shot.leds) >= LEAST_OUTLINE and not any(shot.leds)
        uv[:, [] if outline else list(self.hidden)] = np.nan
        for a, b in self.swapped.items():
            uv[:, [a, b]] = uv[:, [b, a]]
        return Centres(self.clock.now_s + end, shot, uv, np.full((2, 4), 0.12), self.head_reading())

    def _images(self, shot, view, end):
        windows = shot.windows or (Window(0, 0, 1024, 1024),) * 2
        light = 1 + self.light_per_frame * np.arange(len(shot.leds))
        counts = []
        for c, w in enumerate(windows):
            spots = {}
            for m in set(range(4)) - self.hidden:
                power = marker_electrons(view.ranges_m[c, m]) * (1 + view.cosines[c, m]) / 2 * self.brightness
                u, v = view.uv_px[c, m] - (w.u, w.v)
                spots[self.swapped.get(m, m)] = power * spot((w.height, w.width), u, v, view.ranges_m[c, m])
            stack = sequence(self.rng, background_e(self.rng, (w.height, w.width)), shot.leds, spots, light)
            counts.append(self.spoil(stack) if self.spoil else stack)
        return Images(self.clock.now_s + end, shot, windows, tuple(counts), self.head_reading())

    def run(self, action, most_ticks=5000):
        """Poll once a tick until the action ends."""
        for _ in range(most_ticks):
            outcome = action.poll()
            if outcome is not None:
                return outcome
            self.clock.advance()
        raise AssertionError(f"still under way after {most_ticks} ticks")

    def predicted(self, off_m=(0.0, 0.0), off_heading=0.0, sigma_m=0.02, sigma_heading=0.05) -> PoseEstimate:
        """A prediction that is off by this much."""
        from perception.geometry.rotation import rot_z

        body = self.state.site_body
        x, y, z = body.position_m
        return PoseEstimate(
            self.clock.now_s,
            (x + off_m[0], y + off_m[1], z + 0.005),
            quat_from_matrix(rot_z(off_heading) @ body.rotation),
            np.diag([sigma_m**2, sigma_m**2, 0.01**2, 0.02**2, 0.02**2, sigma_heading**2]),
            PoseSource.PREDICTION,
        )


@dataclass
class _Head:
    robot: Robot

    def read(self):
        return self.robot.head_reading()

    def point(self, pan_rad, tilt_rad):
        return self.robot.point(pan_rad, tilt_rad)


@dataclass
class _Tilt:
    robot: Robot

    def read(self):
        angles, _ = roll_pitch(self.robot.state.site_body.rotation)
        sigma = self.robot.chain.rig.rover.inclinometer_sigma_rad
        return TiltReading(self.robot.clock.now_s, *(angles + sigma * self.robot.rng.standard_normal(2)))
