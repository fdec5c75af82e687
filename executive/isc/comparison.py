"""What a check compares: a fix, or a failure, with the prediction since the last fix."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from executive.core.ordered_sum import ordered_sum
from executive.core.types import PoseEstimate, Reason
from executive.isc.correction import innovate
from executive.isc.likelihoods import Measured
from executive.isc.motion import HEADING, MotionState
from executive.isc.readings import Readings

LEAST_TURN_RAD = math.radians(3.0)
LEAST_ADVANCE_M = 0.02


@dataclass(frozen=True)
class Innovation:
    """A fix less the prediction, along the predicted heading and to its left [m], and in heading [rad].

    The standard deviations are those of the fix and the prediction together.
    """

    along_m: float
    cross_m: float
    heading_rad: float
    sigma_along_m: float
    sigma_cross_m: float
    sigma_heading_rad: float

    @classmethod
    def of(cls, motion: MotionState, fix: PoseEstimate) -> Innovation:
        innovation, spread = innovate(motion, fix)
        heading = float(motion.mean[HEADING])
        c, s = math.cos(heading), math.sin(heading)
        along, cross = c * innovation[0] + s * innovation[1], -s * innovation[0] + c * innovation[1]
        across = (-s, c)
        terms = (across[i] * spread[i, j] * across[j] for i in (0, 1) for j in (0, 1))
        sigma_cross = math.sqrt(ordered_sum(terms))
        sigma_along = math.sqrt(max(spread[0, 0] + spread[1, 1] - sigma_cross**2, 1e-12))
        sigma_heading = math.sqrt(spread[2, 2])
        return cls(float(along), float(cross), float(innovation[2]), sigma_along, sigma_cross, sigma_heading)


@dataclass(frozen=True)
class SinceFix:
    """What was predicted since the last fix, turn [rad] and advance [m], and the motor current drawn [A]."""

    turn_rad: float = 0.0
    advance_m: float = 0.0
    current_sum_a: float = 0.0
    current_count: int = 0

    @property
    def mean_current_a(self) -> float | None:
        """None where nothing was driven."""
        return self.current_sum_a / self.current_count if self.current_count else None

    def moved(self, turn_rad: float, advance_m: float) -> SinceFix:
        """After one tick's predicted motion."""
        return replace(self, turn_rad=self.turn_rad + turn_rad, advance_m=self.advance_m + advance_m)

    def drew(self, current_a: float) -> SinceFix:
        """After one tick of driving."""
        count = self.current_count + 1
        return replace(self, current_sum_a=self.current_sum_a + current_a, current_count=count)


@dataclass(frozen=True)
class Comparison:
    """Everything that an evidence channel may be read from.

    At a fix `fix` and `innovation` are there, at a failure its reason and what was said of it. `readings` are
    the latest of the devices, `usual_current_a` the mean motor current of drives that went as predicted
    (None: none yet), `markers_expected` how many markers a fix should rest on (0: the localizer uses none).
    """

    time_s: float
    motion: MotionState
    fix: PoseEstimate | None = None
    innovation: Innovation | None = None
    failure: Reason | None = None
    detail: str = ""
    since: SinceFix = field(default_factory=SinceFix)
    readings: Readings = field(default_factory=Readings)
    usual_current_a: float | None = None
    markers_expected: int = 0

    @property
    def turn_ratio(self) -> Measured[float] | None:
        """Measured turn over predicted; None where too little was turned to say."""
        turn = self.since.turn_rad
        if self.innovation is None or abs(turn) <= LEAST_TURN_RAD:
            return None
        return Measured(1 + self.innovation.heading_rad / turn, self.innovation.sigma_heading_rad / abs(turn))

    @property
    def advance_ratio(self) -> Measured[float] | None:
        """Measured advance over predicted; None where the way was too short to say."""
        advance = self.since.advance_m
        if self.innovation is None or abs(advance) <= LEAST_ADVANCE_M:
            return None
        return Measured(1 + self.innovation.along_m / advance, self.innovation.sigma_along_m / abs(advance))
