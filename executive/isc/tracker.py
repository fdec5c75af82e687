"""The motion model carried on from reading to reading, and set right by fixes."""

from __future__ import annotations

import math

from executive.core.clock import Clock
from executive.core.ports import Devices
from executive.core.rig import Rig
from executive.core.types import PoseEstimate, PoseSource
from executive.isc import correction, prediction
from executive.isc.comparison import SinceFix
from executive.isc.doubt import Doubt
from executive.isc.evidence_check import EvidenceCheck
from executive.isc.gate import Reach
from executive.isc.motion import YAW_EFFICIENCY, MotionNoise, MotionState, start
from executive.isc.readings import Readings, Sensed, sense

LEAST_BLOCKED_TURN_RAD = math.radians(5.0)  # what holds one track turns the rover


class Tracker:
    """The predicted pose and soil, the last readings, and what was predicted since the last fix.

    `fixes` counts those taken in.
    """

    def __init__(self, prior: PoseEstimate, rig: Rig, clock: Clock, noise: MotionNoise) -> None:
        self.motion: MotionState = start(prior, noise)
        self.sensed: Sensed | None = None
        self.since = SinceFix()
        self._gauge_m, self._clock, self._noise = rig.rover.track_gauge_m, clock, noise
        self._before_inflation: MotionState | None = None
        self._reach: Reach | None = None
        self._check = EvidenceCheck()
        self._driven_m = 0.0
        self.fixes = 0
        self.doubt = Doubt(self.motion)

    @property
    def readings(self) -> Readings:
        """The latest readings by device; none before the first."""
        return self.sensed.readings if self.sensed else Readings()

    @property
    def judging(self) -> MotionState:
        """The prediction as it was before it was inflated: what a fix is judged by."""
        return self._before_inflation or self.motion

    @property
    def inflated(self) -> bool:
        """Whether the prediction was inflated since the last fix."""
        return self._before_inflation is not None

    def sense(self, devices: Devices) -> Sensed:
        """Read the continuous channels once and carry the prediction on with them."""
        now = sense(devices, self._clock.now_s)
        before = self.sensed.tracks if self.sensed else now.tracks
        self._carry_on(now.tracks.left_m - before.left_m, now.tracks.right_m - before.right_m)
        if now.tilt is not None:
            self.motion = prediction.level(self.motion, now.tilt)
        if now.tracks.moving and before.moving:
            self.since = self.since.drew(max(now.tracks.left_current_a, now.tracks.right_current_a))
        self.sensed = now
        return now

    def gate_fix(self, fix: PoseEstimate, asked_s: float) -> str | None:
        """Why a fix that was asked for at `asked_s` must not be taken in; None if it may be weighed.

        One that is refused leaves what was driven since the last in doubt.
        """
        why = self._check.refusal(fix, asked_s, self._clock.now_s, self._driven_m)
        why = why or (self._reach.beyond(fix) if self._reach else None)
        if why is not None:
            self.doubt = self.doubt.refused()
        return why

    def take_in(self, fix: PoseEstimate, explained: bool) -> None:
        """Learn from a fix that the model explains, or start from one that it does not."""
        self.fixes += 1
        explained = explained or self.motion.source == PoseSource.PRIOR
        if explained:
            self.motion = correction.correct(self.motion, fix, self._noise)
        else:
            self.motion = correction.reset_pose(self.motion, fix)
        self.doubt = self.doubt.after_fix(fix, explained, self.motion)
        self.since, self._reach, self._before_inflation = SinceFix(), Reach(fix), None

    def inflate(self, along_m: float, across_m: float, heading_rad: float) -> None:
        """Let the next fix lie elsewhere: standard deviations along and across the heading, and in it.

        What the fix then says of the rover is still judged by the prediction as it was before.
        """
        self._before_inflation = self.judging
        self.motion = correction.inflate(self.motion, along_m, across_m, heading_rad)

    def on_blocked(self) -> None:
        """Trust less what was predicted since the last fix: a drive was blocked somewhere on the way."""
        turned = abs(self.since.turn_rad) + LEAST_BLOCKED_TURN_RAD
        along_m = abs(self.since.advance_m)
        self.motion = correction.inflate(self.motion, along_m, along_m * math.sin(turned), turned)

    def reset_parameter(self, parameter: int, ratio: float, sigma: float) -> None:
        """Scale one soil parameter by a ratio seen, with this relative uncertainty."""
        value = float(self.motion.mean[parameter]) * ratio
        turning = parameter == YAW_EFFICIENCY
        low, high = self._noise.range_of_yaw_efficiency if turning else self._noise.range_of_advance
        value = min(max(value, low), high)
        self.motion = correction.reset_parameter(self.motion, parameter, value, sigma * value)

    def _carry_on(self, left_m: float, right_m: float) -> None:
        before, gauge = self.motion, self._gauge_m
        self.motion = prediction.predict(before, left_m, right_m, gauge, self._clock.now_s, self._noise)
        self.doubt = self.doubt.driven(left_m, right_m, gauge, self._clock.now_s, self._noise)
        self._driven_m += (abs(left_m) + abs(right_m)) / 2
        if self._reach is not None:
            self._reach = self._reach.driven(left_m, right_m, gauge)
        travel, rotation = (left_m + right_m) / 2, (right_m - left_m) / gauge
        turn = before.yaw_efficiency * rotation + before.drift_rad_m * travel
        self.since = self.since.moved(turn, before.advance * travel)
