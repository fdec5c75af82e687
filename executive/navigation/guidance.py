"""From a pose and a segment to belt travels: turn on the spot first, then trek in superimposed legs.

Paper, section 3.4: reorient towards the way-point with extra rotations, then proceed on a line; each new
pose superimposes a correction. No correction inside the on-track margin, unless the rover would miss the
tolerance zone; none at all beyond the off-track margin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from executive.core.corridor import distance_m as distance_from_m
from executive.core.types import (
    Outcome,
    Point,
    PoseEstimate,
    Reason,
    Segment,
)
from executive.isc.attitude import wrap_rad
from executive.isc.motion import MotionState


@dataclass(frozen=True)
class Belts:
    """Belt travels to command [m]."""

    left_m: float
    right_m: float


@dataclass(frozen=True)
class GuidanceLimits:
    """What a trek may do before it has to turn on the spot again."""

    steer_limit_rad: float = math.radians(12.0)
    miss_fraction: float = 0.3  # of the tolerance: the miss that is worth a correction
    slack_m: float = (
        0.006  # the miss that `trek_to` does not turn for: no turn on the spot is finer than that
    )
    sigmas: float = 3.0


def heading_error_rad(pose: PoseEstimate, target: Point) -> float:
    """How far the rover must turn (left positive) to face `target`."""
    bearing = math.atan2(target.y_m - pose.y_m, target.x_m - pose.x_m)
    return wrap_rad(bearing - pose.heading_rad)


def distance_m(pose: PoseEstimate, target: Point) -> float:
    return math.hypot(target.x_m - pose.x_m, target.y_m - pose.y_m)


def turn(motion: MotionState, angle_rad: float, gauge_m: float) -> Belts:
    """Belt travels that turn by `angle_rad` on the spot, at the efficiency learnt so far."""
    rotation = angle_rad / motion.yaw_efficiency
    return Belts(-rotation * gauge_m / 2, rotation * gauge_m / 2)


def within_room(belts: Belts, room_m: float) -> Belts:
    """A turn cut short to as much belt travel [m] as there is room.

    What is in the way of a turn pushes the rover aside, beside a rock by half of the belts' travel.
    """
    longest_m = max(abs(belts.left_m), abs(belts.right_m))
    share = min(1.0, max(room_m, 0.0) / longest_m) if longest_m else 1.0
    return Belts(share * belts.left_m, share * belts.right_m)


def straight(motion: MotionState, distance_m: float, turn_rad: float, gauge_m: float) -> Belts:
    """Belt travels that advance by `distance_m` while turning by `turn_rad`, drift compensated."""
    travel = distance_m / motion.advance
    rotation = (turn_rad - motion.drift_rad_m * travel) / motion.yaw_efficiency
    return Belts(travel - rotation * gauge_m / 2, travel + rotation * gauge_m / 2)


def plan_leg(
    motion: MotionState,
    pose: PoseEstimate,
    target: Point,
    segment: Segment,
    longest_m: float,
    gauge_m: float,
    limits: GuidanceLimits,
) -> Outcome[Belts]:
    """The next leg towards `target`, DONE with its belts; or why there is none.

    OFF_HEADING: must turn on the spot first, as going straight on would miss the target. OFF_TRACK: would
    come too near the off-track margin.
    """
    remaining = distance_m(pose, target)
    error = heading_error_rad(pose, target)
    if abs(error) > math.pi / 2 and remaining <= 2 * segment.tolerance_m:
        return Outcome(Reason.OVERSHOOT, f"the target lies {remaining * 1e3:.0f} mm behind")
    miss = remaining * math.sin(error)
    sharp = abs(error) > limits.steer_limit_rad
    near_enough = abs(miss) <= max(limits.slack_m, limits.miss_fraction * segment.tolerance_m)
    if sharp and not (near_enough and abs(error) < math.pi / 2):
        return Outcome(Reason.OFF_HEADING, f"{math.degrees(error):.1f} deg off the bearing to the target")
    offset = segment.offset(pose.x_m, pose.y_m)
    needed = (
        abs(offset.cross_m) > segment.on_track_m or abs(miss) > limits.miss_fraction * segment.tolerance_m
    )
    leg = min(longest_m, remaining)
    steer = error if needed and not sharp else 0.0
    drift_m = leg * abs(math.sin(wrap_rad(pose.heading_rad - segment.bearing_rad)))
    approaching = offset.cross_m * math.sin(wrap_rad(pose.heading_rad - segment.bearing_rad)) > 0
    strayed_m = distance_from_m(segment, pose.x_m, pose.y_m)
    worst = strayed_m + limits.sigmas * pose.sigma_position_m + (drift_m if approaching else 0.0)
    if worst >= segment.off_track_m:
        return Outcome(Reason.OFF_TRACK, f"may come {worst * 1e3:.0f} mm off the segment on the next leg")
    return Outcome(Reason.DONE, value=straight(motion, leg, steer, gauge_m))
