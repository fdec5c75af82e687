"""How far the head's frame is off, from what moved between two pictures of ground that does not.

Eight numbers: the rotation vector and the shift of the head's frame in `site`, about the crossing of its
axes, and how far the right camera has turned against the left one (yaw, pitch). A fit that few of the matches
agree with is none: the pictures then show something else than moved ground.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from executive.core.types import (
    Array,
    Centres,
    Images,
    Vec2,
)
from perception.geometry.chain import Chain
from perception.geometry.head_model import axes_site
from perception.geometry.rotation import exp_map, rot_z, skew
from perception.head.registration import Matches, matched

SIZE = 8
LEAST_MATCHES = 8  # a camera
LEAST_SHARE = 0.6  # of the matches must agree with the fit
_STEPS, _OUTLIER, _MOST_REST_PX, _SIGMA_PX = 12, 3.0, 1.0, 0.03
_PRIOR_SIGMA = np.array([0.2] * 3 + [0.1] * 3 + [0.02] * 2)  # what a head on a lander might do [rad, m]
_SHIFT_SIGMA_M, _APART_SIGMA_RAD = 0.0003, 1e-5  # what patches are off by in common, as measured
_UNLEVEL = 0.02  # ground that is not level, as it is taken for, spoils this share of a motion found
_LEAST_DOWN = 0.05  # a line of sight flatter than this meets no ground near by


@dataclass(frozen=True, eq=False)
class Alignment:
    """The head's frame against the ground: `mean` (8,) with `covariance` (8, 8), see above [rad, m]."""

    mean: Array
    covariance: Array

    def fuse(self, other: Alignment) -> Alignment:
        """What two independent looks say together."""
        mine, theirs = np.linalg.inv(self.covariance), np.linalg.inv(other.covariance)
        covariance = np.linalg.inv(mine + theirs)
        return Alignment(covariance @ (mine @ self.mean + theirs @ other.mean), covariance)

    def error_at(self, chain: Chain, point_site_m: Array) -> tuple[Array, Array]:
        """By how much a fix at a point (3,) in `site` is off, and its covariance: (3,) and (3, 3) [m, m2]."""
        arm = point_site_m - [0.0, 0.0, chain.rig.head.mast_height_m]
        range_m = float(np.linalg.norm(arm))
        base_m = math.dist(*(camera.position_ih_m for camera in chain.rig.cameras))
        E = np.zeros((3, SIZE))
        E[:, :3], E[:, 3:6] = -skew(arm), np.eye(3)
        E[:, 6] = arm * range_m / base_m  # what turns one camera against the other moves along the sight
        return E @ self.mean, E @ self.covariance @ E.T

    def as_sentence(self, bearing_rad: float) -> str:
        """In words, for a head that looks in this direction: about which axis it is off, and how much."""
        roll, tilt, pan = np.degrees(rot_z(bearing_rad).T @ self.mean[:3])
        shift_mm = 1e3 * float(np.linalg.norm(self.mean[3:6]))
        apart_deg = math.degrees(math.hypot(*self.mean[6:]))
        return (
            f"pan {pan:+.2f}, tilt {tilt:+.2f}, roll {roll:+.2f} deg, shift {shift_mm:.0f} mm, "
            f"cameras {apart_deg:.3f} deg apart"
        )


def align(chain: Chain, before: Images | Centres, after: Images | Centres) -> Alignment | str:
    """How the head has moved between two pictures, beyond what its encoders say; or why that is not known."""
    pairs = matched(before, after, chain.rig.sensor.noise_counts)
    few = min(len(m.before_px) for m in pairs)
    if few < LEAST_MATCHES:
        return f"{few} patches of ground found again, {LEAST_MATCHES} wanted"
    was_rad = (before.head.pan_rad, before.head.tilt_rad)
    is_rad = (after.head.pan_rad, after.head.tilt_rad)
    sights = [_Sights.of(chain, camera, pairs[camera], was_rad) for camera in (0, 1)]
    return _fitted(chain, sights, is_rad)


@dataclass(frozen=True, eq=False)
class _Sights:
    """One camera's matches: the ground (n, 3) in `site` that was seen, and where it is seen now (n, 2)."""

    camera: int
    ground_site_m: Array
    after_px: Array

    @classmethod
    def of(cls, chain: Chain, camera: int, matches: Matches, head_rad: Vec2) -> _Sights:
        """Ground taken for level with the lander's foot: its depth matters for the shift alone."""
        both = np.broadcast_to(matches.before_px, (2, *matches.before_px.shape))
        head = chain.site_ih(head_rad)
        rays = chain.model.rays_ih(both)[camera] @ head.rotation.T
        eye = head.apply(chain.model.position_ih_m[camera][None])[0]
        down = np.maximum(-rays[:, 2], _LEAST_DOWN)
        return cls(camera, eye + rays * (eye[2] / down)[:, None], matches.after_px)

    def rest(self, chain: Chain, head_rad: Vec2, x: Array) -> tuple[Array, Array]:
        """Seen less expected pixels (n, 2) for a head off by x, and the expected ones' slope (n, 2, 8)."""
        mast = np.array([0.0, 0.0, chain.rig.head.mast_height_m])
        turned = (self.ground_site_m - mast - x[3:6]) @ exp_map(x[:3])
        uv, by_state = chain.project_points(
            mast + turned, head_rad, np.zeros_like(turned), np.zeros((len(turned), 3, 2))
        )
        by_point = by_state[self.camera][:, :, :3]
        slope = np.empty((len(turned), 2, SIZE))
        slope[:, :, :3], slope[:, :, 3:6] = by_point @ skew(turned), -by_point
        half_px = chain.model.focal_px[self.camera] * (0.5 if self.camera else -0.5)
        slope[:, :, 6:] = half_px * np.eye(2)
        expected = uv[self.camera] + half_px * x[6:]
        return self.after_px - expected, slope


def _fitted(chain: Chain, sights: list[_Sights], head_rad: Vec2) -> Alignment | str:
    """Least squares in which what does not agree counts less and less."""
    x, prior = np.zeros(SIZE), np.diag(_PRIOR_SIGMA**-2)
    information, size, scale = prior, np.zeros(1), _MOST_REST_PX
    for _ in range(_STEPS):
        parts = [s.rest(chain, head_rad, x) for s in sights]
        rest, slope = (np.concatenate(part) for part in zip(*parts, strict=True))
        size = np.linalg.norm(rest, axis=1)
        scale = max(1.2 * float(np.median(size)), _SIGMA_PX)
        weight = 1.0 / (1.0 + (size / (2 * scale)) ** 2) ** 2
        information = prior + np.einsum("n,nki,nkj->ij", weight, slope, slope) / scale**2
        pull = np.einsum("n,nki,nk->i", weight, slope, rest) / scale**2 - prior @ x
        x = x + np.linalg.solve(information, pull)
    agree = size < _OUTLIER * scale
    if scale > _MOST_REST_PX or agree.mean() < LEAST_SHARE:
        return f"{agree.mean():.0%} of {len(size)} patches of ground agree to {scale:.1f} px"
    covariance = np.linalg.inv(information)
    covariance[:3, :3] += _pointing_covariance(chain, head_rad)
    moved_m = chain.rig.head.mast_height_m * np.linalg.norm(x[:3]) + np.linalg.norm(x[3:6])
    astray_m = _UNLEVEL * float(moved_m)
    covariance[3:6, 3:6] += (_SHIFT_SIGMA_M**2 + astray_m**2) * np.eye(3)
    covariance[6:, 6:] += _APART_SIGMA_RAD**2 * np.eye(2)
    return Alignment(x, covariance)


def _pointing_covariance(chain: Chain, head_rad: Vec2) -> Array:
    """Of the rotation between two moves to the same angles, each missed by the head as it does [rad2]."""
    pan_sigma, tilt_sigma = chain.encoder_sigma_rad()[:2]
    pan_axis, tilt_axis = axes_site(chain.rig.head, head_rad)
    once = pan_sigma**2 * np.outer(pan_axis, pan_axis) + tilt_sigma**2 * np.outer(tilt_axis, tilt_axis)
    return np.asarray(2 * once)
