"""A point from its pixels and a known height."""

import numpy as np
import pytest

from executive.core.rig import RigCalibration
from perception.geometry.camera import StereoModel
from perception.geometry.coarse_position import coarse_position


@pytest.mark.parametrize("blind", [None, 0, 1])
def test_coarse_position_on_a_known_height_is_true_to_its_covariance(blind):
    rng, model = np.random.default_rng(5), StereoModel.of(RigCalibration())
    truth, nees = np.array([3.0, 0.1, -0.4]), []
    normal = np.array([-np.sin(0.4), 0.0, np.cos(0.4)])
    for _ in range(300):
        uv = model.project(truth[None])[:, 0] + 8.0 * rng.standard_normal((2, 2))
        if blind is not None:
            uv[blind] = np.nan
        height = float(normal @ truth + 0.03 * rng.standard_normal())
        point, P = coarse_position(model, uv, np.full(2, 8.0), (normal, height, 0.03))
        nees.append((point - truth) @ np.linalg.solve(P, point - truth))
    assert np.mean(nees) == pytest.approx(3.0, abs=0.5)


def test_coarse_position_needs_one_camera():
    with pytest.raises(ValueError, match="NaN for both cameras"):
        coarse_position(
            StereoModel.of(RigCalibration()),
            np.full((2, 2), np.nan),
            np.ones(2),
            (np.array([0, 0, 1.0]), 0.0, 1.0),
        )
