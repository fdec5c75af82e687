"""What a fix must be to be one at all, before it is held against anything: the door that every fix passes.

A fix is refused that is no number, that is older than the question or than the last fix, that comes from the
future, whose covariance cannot be one, and that repeats an earlier fix in every digit although the rover was
driven since: noise does not repeat itself, records do.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from executive.core.types import Array, PoseEstimate, Vec2

DRIVEN_M = 0.005  # of belt travel: less is jitter of the counters, and the rover may rest
ASYMMETRY = 1e-6  # of the largest entry: rounding
NEGATIVE = 1e-9  # of the largest eigenvalue: rounding
LEAST_SIGMA_M, LEAST_SIGMA_RAD = 5e-5, 5e-5
"""A metre of aluminium grows by so much [m] in two kelvin, and leans by it [rad]: nothing that stands in the
sun knows a place better. A covariance that says so was not estimated; that of the best fixes says eight times
as much."""


@dataclass
class EvidenceCheck:
    """Remembers what fixes were given so far, and how far the belts had come by then."""

    _given: dict[Vec2, float] = field(default_factory=dict)
    _last_s: float | None = None

    def refusal(self, fix: PoseEstimate, asked_s: float, now_s: float, driven_m: float) -> str | None:
        """Why this is no fix, None if it is one. `driven_m` is all belt travel so far, without sign [m]."""
        why = unusable(fix, asked_s) or self._misdated(fix, now_s) or unfit(fix.covariance)
        return why or self._repeated(fix, driven_m)

    def _misdated(self, fix: PoseEstimate, now_s: float) -> str | None:
        if fix.time_s > now_s:
            return f"the pose found is from {fix.time_s - now_s:.0f} s ahead"
        if self._last_s is not None and fix.time_s < self._last_s:
            return f"the pose found is {self._last_s - fix.time_s:.0f} s older than the last one"
        self._last_s = fix.time_s
        return None

    def _repeated(self, fix: PoseEstimate, driven_m: float) -> str | None:
        place = (fix.x_m, fix.y_m)
        since_m = driven_m - self._given.setdefault(place, driven_m)
        if since_m < DRIVEN_M:
            return None
        return (
            f"the pose found equals an earlier one in every digit, {since_m * 1e3:.0f} mm of belt travel ago"
        )


def unusable(fix: PoseEstimate, since_s: float) -> str | None:
    """Why an estimate that was asked for at `since_s` says nothing at all; None if it may be weighed."""
    numbers = np.array([*fix.position_site_m, *fix.quat_site_body, fix.time_s])
    if not (np.isfinite(numbers).all() and np.isfinite(fix.covariance).all()):
        return "the pose found is no number"
    if fix.time_s < since_s:
        return f"the pose found is {since_s - fix.time_s:.0f} s older than the question"
    return None


def unfit(covariance: Array) -> str | None:
    """Why a finite matrix (6, 6) cannot be the covariance of a fix; None if it can."""
    largest = float(np.abs(covariance).max())
    if float(np.abs(covariance - covariance.T).max()) > ASYMMETRY * largest:
        return "the covariance of the pose found is not symmetric"
    values = np.linalg.eigvalsh(covariance)
    if values[0] < -NEGATIVE * max(float(values[-1]), 0.0) or values[-1] <= 0.0:
        return "the covariance of the pose found is not positive"
    planar = np.linalg.eigvalsh(covariance[:2, :2])
    if planar[0] < LEAST_SIGMA_M**2 or covariance[5, 5] < LEAST_SIGMA_RAD**2:
        return "the covariance of the pose found is smaller than anything can measure"
    return None
