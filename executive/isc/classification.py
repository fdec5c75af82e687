"""In-situ classification: predict, compare, weigh hypotheses, extrapolate (paper, section 3.2)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from executive.core.clock import Clock
from executive.core.ports import Devices
from executive.core.rig import RigCalibration
from executive.core.types import (
    Outcome,
    PoseEstimate,
    PoseSource,
    Reason,
    Segment,
    TetherReading,
    TiltReading,
    TrackReading,
)
from executive.isc import prediction
from executive.isc.hypotheses import (
    FAILURE_CODES,
    PRIOR,
    SEEING,
    Channel,
    Evidence,
    Hypothesis,
    weigh,
    without,
)
from executive.isc.prediction import MotionNoise, MotionState
from executive.isc.reach import Reach

LEAST_TURN_RAD = math.radians(3.0)
LEAST_ADVANCE_M = 0.02
LEAST_BLOCKED_TURN_RAD = math.radians(5.0)  # what holds one track turns the rover


@dataclass(frozen=True)
class Assessment:
    """What the classification makes of it: weights, the likeliest anomaly, and its severity.

    `time_to_margin_s` is when, going on as now, the off-track margin would be crossed; None for never.
    """

    time_s: float
    weights: Mapping[Hypothesis, float]
    time_to_margin_s: float | None
    evidence: Evidence | None

    @property
    def likeliest(self) -> Hypothesis:
        return max(self.weights, key=lambda h: self.weights[h])

    @property
    def anomaly(self) -> tuple[Hypothesis, float]:
        """The likeliest hypothesis other than nominal, and its weight."""
        others = {h: w for h, w in self.weights.items() if h is not Hypothesis.NOMINAL}
        best = max(others, key=lambda h: others[h])
        return best, others[best]


@dataclass(frozen=True)
class Telemetry:
    """One tick's readings of everything that is read continuously."""

    time_s: float
    tracks: TrackReading
    tilt: TiltReading
    tether: TetherReading


@dataclass
class _SinceFix:
    """What was predicted since the last fix, to be held against the next one."""

    turn_rad: float = 0.0
    advance_m: float = 0.0
    currents: list[float] = field(default_factory=list)


class Classification:
    """Keeps the motion model and the hypotheses; told of every reading, fix and failure."""

    def __init__(
        self, prior: PoseEstimate, rig: RigCalibration, clock: Clock, noise: MotionNoise | None = None
    ) -> None:
        self.noise = noise or MotionNoise()
        self.motion: MotionState = prediction.start(prior, self.noise)
        self.weights: dict[Hypothesis, float] = dict(PRIOR)
        self.evidence: Evidence | None = None
        self.telemetry: Telemetry | None = None
        self.observed_turn_ratio: float | None = None
        self.observed_advance_ratio: float | None = None
        self._rig, self._clock = rig, clock
        self._since = _SinceFix()
        self._undoubted: MotionState | None = None
        self._current_baseline_a: float | None = None
        self._reach: Reach | None = None

    def sense(self, devices: Devices) -> Telemetry:
        """Read the continuous channels once and carry the prediction on with them."""
        now = Telemetry(
            self._clock.now_s, devices.tracks.read(), devices.inclinometer.read(), devices.tether.read()
        )
        before = self.telemetry.tracks if self.telemetry else now.tracks
        self._carry_on(now.tracks.left_m - before.left_m, now.tracks.right_m - before.right_m)
        self.motion = prediction.level(self.motion, now.tilt)
        if now.tracks.moving and before.moving:
            self._since.currents.append(max(now.tracks.left_current_a, now.tracks.right_current_a))
        self.telemetry = now
        return now

    def _carry_on(self, left_m: float, right_m: float) -> None:
        gauge = self._rig.rover.track_gauge_m
        before = self.motion
        self.motion = prediction.predict(before, left_m, right_m, gauge, self._clock.now_s, self.noise)
        if self._reach is not None:
            self._reach = self._reach.driven(left_m, right_m, gauge)
        travel, rotation = (left_m + right_m) / 2, (right_m - left_m) / gauge
        self._since.advance_m += before.advance * travel
        self._since.turn_rad += before.yaw_efficiency * rotation + before.drift_rad_m * travel

    def predicted(self) -> PoseEstimate:
        """Where the rover should be now."""
        return self.motion.pose()

    def joined(self, fix: PoseEstimate) -> PoseEstimate:
        """The fix just taken in, joined with what was predicted."""
        return prediction.joined(self.motion, fix)

    def beyond_reach(self, fix: PoseEstimate) -> str | None:
        """Why the rover cannot have come to where a fix sees it, None if it can."""
        return None if self._reach is None else self._reach.beyond(fix)

    def fixed(self, fix: PoseEstimate) -> Assessment:
        """Compare a precise fix with the prediction, weigh, and learn if the fix is explained."""
        evidence = self._compare(fix, self._undoubted or self.motion)
        self._weigh(evidence)
        if self._undoubted is not None:  # measured again: a false fix would not have repeated itself
            self.weights = without(self.weights, Hypothesis.LOCALISATION_OUTLIER)
            self._undoubted = None
        if self._motion_explained > 0.5 or self.motion.source == PoseSource.PRIOR:
            self.motion = prediction.correct(self.motion, fix, self.noise)
        else:
            self.motion = prediction.relocate(self.motion, fix)
        self._remember_baseline()
        self._since = _SinceFix()
        self._reach = Reach(fix)
        return self.assess(fix)

    def failed(self, outcome: Outcome[object]) -> Assessment:
        """Weigh the reason of a failure; after a blocked drive, doubt what was predicted since the fix."""
        if outcome.reason is Reason.BLOCKED:
            turned = abs(self._since.turn_rad) + LEAST_BLOCKED_TURN_RAD
            along_m = abs(self._since.advance_m)
            self.motion = prediction.doubt(self.motion, along_m, along_m * math.sin(turned), turned)
        reason = {Channel.FAILURE: (FAILURE_CODES[outcome.reason], 0.0)}
        self._weigh(Evidence(self._clock.now_s, reason | self._pull()))
        return self.assess(self.predicted())

    def doubt(self, along_m: float, across_m: float, heading_rad: float) -> None:
        """Let the next fix lie elsewhere: standard deviations along and across the heading, and in it.

        What the fix then says of the rover is still judged by the prediction before the doubt.
        """
        self._undoubted = self._undoubted or self.motion
        self.motion = prediction.doubt(self.motion, along_m, across_m, heading_rad)

    def assess(self, pose: PoseEstimate, segment: Segment | None = None) -> Assessment:
        """The present weights, and where this leads on `segment`."""
        time_to_margin = None if segment is None else self._time_to_margin(pose, segment)
        return Assessment(self._clock.now_s, dict(self.weights), time_to_margin, self.evidence)

    def settle(self) -> None:
        """Return the hypotheses to their prior: the last anomaly has been dealt with."""
        self.weights = dict(PRIOR)

    def adopt(self, parameter: int, ratio: float, sigma: float) -> None:
        """Scale one soil parameter by a ratio seen, with this relative uncertainty."""
        value = float(self.motion.mean[parameter]) * ratio
        low, high = (
            self.noise.range_of_yaw_efficiency
            if parameter == prediction.YAW_EFFICIENCY
            else self.noise.range_of_advance
        )
        value = min(max(value, low), high)
        self.motion = prediction.adopt(self.motion, parameter, value, sigma * value)

    @property
    def _motion_explained(self) -> float:
        """The weight of all hypotheses under which the rover moved as the model says."""
        return sum(w for h, w in self.weights.items() if h is Hypothesis.NOMINAL or h in SEEING)

    def _weigh(self, evidence: Evidence) -> None:
        self.evidence = evidence
        self.weights = weigh(self.weights, evidence)

    def _compare(self, fix: PoseEstimate, motion: MotionState) -> Evidence:
        innovation, spread = prediction.innovate(motion, fix)
        heading = float(motion.mean[prediction.HEADING])
        c, s = math.cos(heading), math.sin(heading)
        along, cross = c * innovation[0] + s * innovation[1], -s * innovation[0] + c * innovation[1]
        across = (-s, c)
        sigma_cross = math.sqrt(sum(across[i] * spread[i, j] * across[j] for i in (0, 1) for j in (0, 1)))
        sigma_along = math.sqrt(max(spread[0, 0] + spread[1, 1] - sigma_cross**2, 1e-12))
        channels: dict[Channel, tuple[float, float]] = {
            Channel.MARKERS: (float(fix.markers), 0.0),
            Channel.TILT: (fix.tilt_rad, 0.0),
            Channel.CROSS_Z: (cross / sigma_cross, 0.0),
        }
        turn, advance = self._since.turn_rad, self._since.advance_m
        self.observed_turn_ratio = self.observed_advance_ratio = None
        if abs(turn) > LEAST_TURN_RAD:
            self.observed_turn_ratio = 1 + float(innovation[2]) / turn
            channels[Channel.TURN_RATIO] = (self.observed_turn_ratio, math.sqrt(spread[2, 2]) / abs(turn))
        else:
            channels[Channel.HEADING_Z] = (float(innovation[2]) / math.sqrt(spread[2, 2]), 0.0)
        if abs(advance) > LEAST_ADVANCE_M:
            self.observed_advance_ratio = 1 + float(along) / advance
            channels[Channel.ADVANCE_RATIO] = (self.observed_advance_ratio, sigma_along / abs(advance))
        if self._since.currents and self._current_baseline_a:
            channels[Channel.CURRENT_RATIO] = (self._mean_current() / self._current_baseline_a, 0.0)
        return Evidence(self._clock.now_s, channels | self._pull())

    def _pull(self) -> dict[Channel, tuple[float, float]]:
        """What the tether says, once it has been read."""
        return {Channel.TETHER: (self.telemetry.tether.tension_n, 0.0)} if self.telemetry else {}

    def _mean_current(self) -> float:
        return sum(self._since.currents) / len(self._since.currents)

    def _remember_baseline(self) -> None:
        if not self._since.currents or self._motion_explained < 0.5:
            return
        seen = self._mean_current()
        old = self._current_baseline_a
        self._current_baseline_a = seen if old is None else 0.7 * old + 0.3 * seen

    def _time_to_margin(self, pose: PoseEstimate, segment: Segment) -> float | None:
        offset = segment.offset(pose.x_m, pose.y_m)
        speed = self._rig.rover.speed_m_s * self.motion.advance
        rate = speed * math.sin(prediction.wrap_rad(pose.heading_rad - segment.bearing_rad))
        left = segment.off_track_m - offset.cross_m if rate > 0 else segment.off_track_m + offset.cross_m
        return None if abs(rate) < 1e-9 else max(left, 0.0) / abs(rate)
