"""What is learnt from a fix stays within what soil can do."""

from dataclasses import replace

import numpy as np
import pytest

from executive.core.types import PoseEstimate
from executive.isc.attitude import quat_from_heading_tilt
from executive.isc.correction import correct
from executive.isc.motion import ADVANCE, YAW_EFFICIENCY, MotionNoise, start


def at(x_m=0.0, heading_rad=0.0):
    quat = quat_from_heading_tilt(heading_rad, 0.0, 0.0)
    return PoseEstimate(0.0, (x_m, 0.0, 0.0), quat, np.eye(6) * 1e-6, "markers")


def learnt(parameter, index, fix):
    """A soil parameter after a fix, where the way since the last tells all about it: a metre, or a radian."""
    state = start(at(), MotionNoise())
    covariance = np.diag([1e-6] * 6)
    covariance[index, index] = covariance[parameter, parameter] = 1.0
    covariance[index, parameter] = covariance[parameter, index] = 1.0 - 1e-6
    return correct(replace(state, covariance=covariance), fix, MotionNoise()).mean[parameter]


@pytest.mark.parametrize(("x_m", "advance"), [(5.0, 1.2), (-5.0, 0.2), (0.1, 1.05)])
def test_the_learnt_advance_stays_between_deep_sand_and_a_slope_that_pushes(x_m, advance):
    """Above it legs are planned far too short; below, so long that one good grip leaves the corridor."""
    assert learnt(ADVANCE, 0, at(x_m)) == pytest.approx(advance, abs=1e-4)


@pytest.mark.parametrize(("heading_rad", "efficiency"), [(3.0, 1.5), (-3.0, 0.08), (0.1, 0.65)])
def test_the_learnt_turning_stays_within_what_tracks_can_do(heading_rad, efficiency):
    """Below 0.08 a turn would be planned twelve times too long: one good grip turns the rover about."""
    assert learnt(YAW_EFFICIENCY, 2, at(heading_rad=heading_rad)) == pytest.approx(efficiency, abs=1e-4)
