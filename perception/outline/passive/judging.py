"""Whether the best pose is to be believed, and how far: gates, covariance, and words for a refusal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from executive.core.ordered_sum import ordered_sum
from executive.core.types import Array
from perception.geometry.body import Transform
from perception.geometry.chain import Chain
from perception.geometry.pose import chi2_limit
from perception.geometry.rotation import skew
from perception.outline.passive.alignment import Aligned
from perception.outline.passive.matching import CameraScene, Detail

_GATE = 0.999
_LEAST_EXPLAINED = 0.5  # of what changed against the background
_MOST_MISFIT = 2.0  # squared sigmas a pixel; 1.6 in 99 of 100 fixes, 4 and more with a wrong heading
_MOST_DETAIL = 0.16  # that the drawing may leave out, over the ground's brightness
_USUAL_DETAIL = 0.05  # beyond, shades within a surface move the pose: from the side, twice the error at 0.11
_FLOOR_PX = 0.07  # what background, drawing and lens calibration leave
_ARM_M = 0.15  # from the rover's middle to its ends, at which yaw is seen


@dataclass(frozen=True)
class Ground:
    """Height of the surveyed ground under the rover [m, site] and how well it is known."""

    height_m: float
    sigma_m: float


@dataclass(frozen=True)
class Sun:
    """Where the sun stands, to a degree or so: azimuth from site x, left positive, and elevation [rad]."""

    azimuth_rad: float
    elevation_rad: float


@dataclass(frozen=True, eq=False)
class PassiveFix:
    """An accepted pose: body in site, covariance (6, 6) as in PoseEstimate, what it rests on, and the sun by
    which the shadow was drawn."""

    site_body: Transform
    covariance: Array
    explained: float
    sun: Sun
    note: str


@dataclass(frozen=True)
class PassiveRefusal:
    """Why there is no fix."""

    why: str


def judged(
    chain: Chain, best: Aligned, scenes: Sequence[CameraScene], details: Sequence[Detail], ground: Ground
) -> PassiveFix | PassiveRefusal:
    """The best pose as a fix, or what speaks against it."""
    if not best.converged:
        return PassiveRefusal("no best pose was reached")
    left_out = max(d.rover / s.brightness for s, d in zip(scenes, details, strict=True))
    if left_out > _MOST_DETAIL:
        return PassiveRefusal(f"the rover's drawing leaves {left_out:.0%} of the brightness open")
    if best.misfit > _MOST_MISFIT:
        return PassiveRefusal(
            f"the images differ by {best.misfit:.1f} squared sigmas a pixel from any pose's"
        )
    explained = _explained(best, scenes)
    if explained < _LEAST_EXPLAINED:
        return PassiveRefusal(f"the rover explains {explained:.0%} of what changed")
    covariance = _site_covariance(chain, best, max(left_out / _USUAL_DETAIL, 1.0))
    body = best.site_body
    off = ground.height_m - body.position_m[2]
    sigma = math.hypot(ground.sigma_m, math.sqrt(covariance[2, 2]))
    if (off / sigma) ** 2 > chi2_limit(1, _GATE):
        return PassiveRefusal(
            f"the ground was surveyed {off * 1e3:.0f} mm off where the rover stands, "
            f"{abs(off) / sigma:.1f} sigmas"
        )
    note = f"outline explains {explained:.0%} of what changed; ground {off * 1e3:+.1f} mm off the survey"
    sun = Sun(*best.start.sun_rad.tolist())
    return PassiveFix(body, covariance, explained, sun, note)


def _explained(best: Aligned, scenes: Sequence[CameraScene]) -> float:
    """Share of the change against the background that rover and shadow account for."""
    changed = ordered_sum(float(((s.image - s.background.counts) ** 2).sum()) for s in scenes)
    left = ordered_sum(float((m.residual[0] ** 2).sum()) for m in best.matches)
    return 1 - left / max(changed, 1e-9)


def _site_covariance(chain: Chain, best: Aligned, looser: float) -> Array:
    """Covariance (6, 6) of the body in site: of the images, `looser` times as far off as they would have it,
    of the head's angles, and a floor."""
    turn = np.eye(6)
    turn[:3, :3] = best.start.axes
    covariance = looser**2 * turn @ best.covariance[:6, :6] @ turn.T
    body = best.site_body
    arm = body.position_m - best.start.eye_m
    lateral = best.start.axes[:, 1]
    by_head = np.zeros((6, 2))
    by_head[:3, 0], by_head[3:, 0] = skew(np.array([0.0, 0.0, 1.0])) @ arm, [0.0, 0.0, 1.0]
    by_head[:3, 1] = skew(lateral) @ arm  # roll and pitch come from the inclinometers, whatever the head says
    head = chain.encoder_sigma_rad()[:2]
    total: Array = covariance + by_head @ np.diag(head**2) @ by_head.T + _floor(chain, best)
    return (total + total.T) / 2


def _floor(chain: Chain, best: Aligned) -> Array:
    """What a few hundredths of a pixel, alike over a whole image, do to the pose."""
    cameras = chain.rig.cameras
    base_m = float(np.linalg.norm(np.subtract(cameras[0].position_ih_m, cameras[1].position_ih_m)))
    range_m, focal_px = best.start.range_m, cameras[0].focal_px
    sight = best.site_body.position_m - best.start.eye_m
    sight = sight / range_m
    along = math.sqrt(2.0) * _FLOOR_PX * range_m**2 / (focal_px * base_m)
    across = _FLOOR_PX * range_m / focal_px
    floor = np.zeros((6, 6))
    floor[:3, :3] = across**2 * np.eye(3) + along**2 * np.outer(sight, sight)
    floor[3, 3] = floor[4, 4] = chain.rig.rover.inclinometer_sigma_rad**2
    floor[5, 5] = (across / _ARM_M) ** 2
    return floor
