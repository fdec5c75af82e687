"""How well a rover can be found at a place at best, before any mission is driven there."""

from __future__ import annotations

import math

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Point, PoseEstimate, PoseSource, Quality
from executive.isc.attitude import quat_from_heading_tilt
from perception.geometry.body import plc_in_body
from perception.geometry.chain import Chain, body_transform
from perception.geometry.follow_up import pointing_at
from perception.geometry.prediction import expect
from perception.markers.effort import WANTED
from perception.markers.fisher import surface_bound

HEIGHT_SIGMA_M = 0.1
LOOKS = 3  # as `measure_arrival` takes at most


def best_sigma_m(rig: RigCalibration, place: Point) -> float:
    """The least standard deviation of position [m], in its worst direction, to which a rover is found there.

    The Cramer-Rao bound with as many pairs as the looks at an arrival may take, on level ground, facing away
    from the lander with the marker plate leant towards it as far as it goes.
    """
    chain, joints_rad = Chain.of(rig), (0.0, rig.cabin.cabin_limits_rad[1])
    heading_rad = math.atan2(place.y_m, place.x_m)
    pose = PoseEstimate(
        time_s=0.0,
        position_site_m=(place.x_m, place.y_m, 0.0),
        quat_site_body=quat_from_heading_tilt(heading_rad, 0.0, 0.0),
        covariance=np.diag([1e-4] * 6),
        source=PoseSource.PRIOR,
    )
    plate = body_transform(pose) @ plc_in_body(rig.cabin, *joints_rad)
    head_rad = pointing_at(chain, plate.apply(chain.markers_plc_m).mean(axis=0))
    expected = expect(chain, pose, head_rad, joints_rad, (0.0, 0.0))
    bound = surface_bound(chain, expected.state, LOOKS * WANTED[Quality.FAR].most_pairs, HEIGHT_SIGMA_M)
    return math.sqrt(float(np.linalg.eigvalsh(bound[:2, :2])[-1]))
