"""Whether an estimate can carry that a rover stands in the tolerance zone of a way-point.

It does where the whole ellipse of two standard deviations lies in the zone: nearness alone says nothing.
"""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Outcome, Point, PoseEstimate, Reason

SIGMAS = 2.0


def radius_m(pose: PoseEstimate, within_m: float) -> float:
    """How near to the middle of a zone the estimate must lie [m]; negative where no nearness is enough."""
    return within_m - SIGMAS * pose.sigma_position_m


def arrival(pose: PoseEstimate, target: Point, within_m: float) -> Outcome[object]:
    """DONE where it stands in the zone; UNEXPECTED where it does not; ARRIVAL_UNCERTAIN where it may.

    An estimate that is no number carries nothing.
    """
    if not (np.isfinite(pose.covariance).all() and np.isfinite(pose.position_site_m).all()):
        return Outcome(Reason.UNEXPECTED, "the pose is no number")
    away_m = math.hypot(pose.x_m - target.x_m, pose.y_m - target.y_m)
    message = f"{away_m * 1e3:.0f} mm from the way-point, two sigma {2e3 * pose.sigma_position_m:.0f} mm"
    if away_m <= radius_m(pose, within_m):
        return Outcome(Reason.DONE, message)
    if away_m <= within_m:
        return Outcome(Reason.ARRIVAL_UNCERTAIN, f"{message}, tolerance {within_m * 1e3:.0f} mm")
    return Outcome(Reason.UNEXPECTED, f"{message}: outside of its tolerance of {within_m * 1e3:.0f} mm")
