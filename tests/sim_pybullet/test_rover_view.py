"""The order in which the rover's parts are painted."""

import numpy as np
import pytest

from executive.core.rig import RigCalibration
from perception.geometry.body import Transform
from sim_pybullet.rover_solids import rover_solids
from sim_pybullet.rover_view import _far_to_near, _place
from tests.perception.passive_trials import scene

AT_REST = scene(Transform(np.eye(3), np.zeros(3)), (0.0, 0.0), (0.0, 0.0))


@pytest.mark.parametrize("elevation_deg", [8.0, 16.0, 30.0, 50.0])
def test_the_cabin_is_painted_over_the_arm_below_it_seen_from_behind(elevation_deg):
    solids = rover_solids(RigCalibration())
    parts = {solid.name: _place(solid, AT_REST) for solid in solids}
    elevation = np.radians(elevation_deg)
    for azimuth in np.radians(np.arange(150.0, 211.0, 3.0)):
        level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        eye = 5.0 * (np.cos(elevation) * level + np.sin(elevation) * np.array([0.0, 0.0, 1.0]))
        order = _far_to_near(list(parts.values()), eye)
        assert order.index(parts["arm"]) < order.index(parts["cabin"]), np.degrees(azimuth)
