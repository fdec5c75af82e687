"""A pose tendency while moving: two frames, motion fragments, a coarse position (paper, 4.1)."""

from __future__ import annotations

import math

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import (
    Array,
    Centres,
    Images,
    PoseEstimate,
    PoseSource,
)
from perception.frames.exposure import plate_view
from perception.geometry.chain import Chain
from perception.geometry.coarse_position import coarse_position
from perception.geometry.prediction import Expectation
from perception.outline.moving_rover import moving_rover

CADENCE_S = 20.0  # at track speed, some 28 mm: a tenth of the rover
LEDS = (0, 0)
_HEIGHT_SIGMA_M = 0.03
_UNKNOWN_M = 10.0
_WINDOW_ROVERS = 1.0  # window margin around the prediction, in rover lengths


def window_margin_px(rig: RigCalibration, range_m: float) -> float:
    """Room around the markers that shows the whole rover before background."""
    return _WINDOW_ROVERS * rig.cameras[0].focal_px * rig.rover.length_m / range_m


def coarse_pose(
    chain: Chain, expectation: Expectation, predicted: PoseEstimate, data: Images | Centres, start_s: float
) -> PoseEstimate | None:
    """Pose with its place measured and its attitude predicted; None where no camera saw the rover move.

    `start_s` is when the shot began: the pose is of the second frame, or of the middle between both for
    centroids of the geometric tier. ValueError unless the frames are as ordered (perception.frames.shots).
    """
    into_shot = 1.0 if isinstance(data, Images) else 0.5
    seen = _seen(chain, expectation, data)
    if seen is None:
        return None
    (x, y, z), P = seen
    covariance = np.array(expectation.covariance)
    covariance[:3, 3:] = covariance[3:, :3] = 0.0
    covariance[:3, :3] = P
    return PoseEstimate(
        time_s=start_s + into_shot * data.shot.cadence_s,
        position_site_m=(float(x), float(y), float(z)),
        quat_site_body=predicted.quat_site_body,
        covariance=covariance,
        source=PoseSource.TREND,
    )


def _seen(chain: Chain, expectation: Expectation, data: Images | Centres) -> tuple[Array, Array] | None:
    """The moving rover's place (3,) in site [m] and its covariance (3, 3)."""
    if isinstance(data, Centres):
        return _from_middles(chain, expectation, data)
    moving = moving_rover(chain, expectation, data, plate_view(chain, expectation.state).range_m)
    return None if moving is None else (moving.position_m, moving.covariance)


def _from_middles(chain: Chain, expectation: Expectation, data: Centres) -> tuple[Array, Array] | None:
    """The same from the middles that the geometric tier gives; the ground's height helps one camera alone."""
    uv = data.uv_px[:, 0]
    seen = np.isfinite(uv).all(axis=1)
    if not seen.any():
        return None
    head = chain.site_ih((data.head.pan_rad, data.head.tilt_rad))
    body = expectation.state.site_body
    to_middle = body.rotation[:, 2] * chain.rig.rover.height_m / 2
    up = head.rotation.T @ [0.0, 0.0, 1.0]
    height = float((body.position_m + to_middle - head.position_m)[2])
    sigma_height = math.hypot(math.sqrt(expectation.covariance[2, 2]), _HEIGHT_SIGMA_M)
    sigma_px = np.nan_to_num(data.sigma_px[:, 0], nan=1.0)
    point, P = coarse_position(
        chain.model, uv, sigma_px, (up, height, _UNKNOWN_M if seen.all() else sigma_height)
    )
    range_m = float(np.linalg.norm(point))
    head_share = np.eye(3) * (range_m * float(chain.encoder_sigma_rad()[:2].max())) ** 2
    return head.apply(point[None])[0] - to_middle, head.rotation @ P @ head.rotation.T + head_share
