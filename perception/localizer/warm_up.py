"""Loads the machine code that a pose from centres takes, so that processes forked afterwards have it."""

from __future__ import annotations

import numpy as np

from executive.core.rig import RigCalibration
from perception.geometry.body import Transform
from perception.geometry.camera import triangulate
from perception.geometry.chain import Chain, ChainState
from perception.geometry.follow_up import pointing_at
from perception.geometry.pose import (
    Prior,
    Sighting,
    estimate,
    guess_body,
    roll_pitch,
)

_CENTRE_PX = 0.1


def warm_up() -> None:
    """Work through one pose, whose outcome nobody needs."""
    chain = Chain.of(RigCalibration())
    body = Transform(np.eye(3), np.array([3.0, 0.0, 0.0]))
    state = ChainState(body, pointing_at(chain, body.position_m), (0.0, 0.0))
    uv, _ = chain.project(state)
    covariance = np.tile(_CENTRE_PX**2 * np.eye(2), (*uv.shape[:2], 1, 1))
    roll, pitch = roll_pitch(body.rotation)[0].tolist()
    sighting = Sighting(uv, covariance, state.head_rad, state.joints_rad, (roll, pitch))
    start = guess_body(chain, triangulate(chain.model, uv), sighting, list(range(uv.shape[1])))
    estimate(chain, sighting, start, Prior(body, np.eye(6)))
