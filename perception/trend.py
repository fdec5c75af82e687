"""A pose tendency while moving: two frames, motion fragments, a coarse position (paper, 4.1)."""

from __future__ import annotations

import math

import numpy as np

from executive.rig import RigCalibration
from executive.types import Array, Centres, Images, PoseEstimate, Source
from perception.chain import Chain
from perception.exposure import view_of
from perception.frames import check_frames
from perception.motion import coarse_position, motion_fragments
from perception.prediction import Expectation

CADENCE_S = 20.0  # at track speed, some 28 mm: a tenth of the rover
LEDS = (0, 0)
# The middle of what moved against the middle of the rover: its cast shadow moves along with it, and pulls
# the middle by half the shadow's length, wherever the sun stands.
_SILHOUETTE_SIGMA_M = 0.05
_HEIGHT_SIGMA_M = 0.03
_WINDOW_ROVERS = 1.5  # window margin around the prediction, in rover lengths


def window_margin_px(rig: RigCalibration, range_m: float) -> float:
    """Room around the markers that shows the whole rover before background."""
    return _WINDOW_ROVERS * rig.cameras[0].focal_px * rig.rover.length_m / range_m


def centroids(rig: RigCalibration, data: Images | Centres, range_m: float) -> tuple[Array, Array]:
    """The moving rover's middle (2, 2) [px], NaN where nothing moved, and its sigma (2,) [px]."""
    silhouette = rig.cameras[0].focal_px * _SILHOUETTE_SIGMA_M / range_m
    if isinstance(data, Centres):
        return data.uv_px[:, 0], np.hypot(np.nan_to_num(data.sigma_px[:, 0]), silhouette)
    check_frames(data, rig.sensor)
    uv = np.full((2, 2), np.nan)
    reach = rig.cameras[0].focal_px * rig.rover.length_m / range_m
    for camera, (window, stack) in enumerate(zip(data.windows, data.counts, strict=True)):
        found = motion_fragments(stack[0], stack[-1], rig.sensor.noise_counts, (window.u, window.v), reach)
        if found is not None:
            uv[camera] = found.latest_px
    return uv, np.full(2, silhouette)


def coarse_pose(
    chain: Chain, expectation: Expectation, predicted: PoseEstimate, data: Images | Centres, start_s: float
) -> PoseEstimate | None:
    """Pose with its place measured and its attitude predicted; None where no camera saw the rover move.

    `start_s` is when the shot began: the pose is of the second frame, or of the middle between both for
    centroids of the geometric tier.
    """
    range_m = view_of(chain, expectation.state).range_m
    into_shot = 1.0 if isinstance(data, Images) else 0.5
    uv, sigma = centroids(chain.rig, data, range_m)
    if not np.isfinite(uv).all(axis=1).any():
        return None
    head = chain.site_ih((data.head.pan_rad, data.head.tilt_rad))
    middle = chain.rig.rover.height_m / 2
    up = head.rotation.T @ [0.0, 0.0, 1.0]
    height = predicted.position_site_m[2] + middle - head.position_m[2]
    sigma_height = math.hypot(math.sqrt(expectation.covariance[2, 2]), _HEIGHT_SIGMA_M)
    point, P = coarse_position(chain.model, uv, sigma, (up, height, sigma_height))
    x, y, z = head.apply(point[None])[0] - [0.0, 0.0, middle]
    covariance = np.array(expectation.covariance)
    covariance[:3, 3:] = covariance[3:, :3] = 0.0
    covariance[:3, :3] = head.rotation @ P @ head.rotation.T + _head_share(chain, range_m)
    return PoseEstimate(
        time_s=start_s + into_shot * data.shot.cadence_s,
        position_site_m=(float(x), float(y), float(z)),
        quat_site_body=predicted.quat_site_body,
        covariance=covariance,
        source=Source.TREND,
    )


def _head_share(chain: Chain, range_m: float) -> Array:
    """What the head's accuracy adds to a position at `range_m`, in any direction (3, 3) [m2]."""
    share: Array = np.eye(3) * (range_m * float(chain.encoder_sigma_rad()[:2].max())) ** 2
    return share
