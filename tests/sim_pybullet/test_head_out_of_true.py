"""Two projections written apart, the simulator's and perception's, agree on a head out of true."""

import numpy as np

from perception.geometry.chain import Chain
from sim_pybullet.projection import head_views
from tests.perception.geometry.test_geometry import TURNED_RIG


def test_simulator_and_perception_see_the_same_through_a_head_out_of_true():
    points = np.array([[4.0, 0.9, 0.3], [7.0, 1.4, 0.1], [12.0, 1.0, 0.0]])
    for reading in ((0.15, 0.2), (-0.3, 0.05), (2.0, 0.6)):
        chain = Chain.of(TURNED_RIG)
        seen = chain.model.project(chain.site_ih(reading).inverse().apply(points))
        simulated = [view.project(points)[0] for view in head_views(TURNED_RIG, *reading)]
        np.testing.assert_allclose(simulated, seen, atol=1e-6)
