"""The scenario on surveyed ground; the elevation model is not part of the project."""

from pathlib import Path

import pytest

from executive.run.app import RunOptions, run

SCENARIO = Path(__file__).parents[2] / "scenarios" / "marsyard.yaml"
MODEL = SCENARIO.parent / "../../shared/reference/dem/marsyard2021.tif"

pytestmark = [
    pytest.mark.sim,
    pytest.mark.slow,
    pytest.mark.skipif(not MODEL.is_file(), reason=f"the elevation model {MODEL.name} is not here"),
]


def test_the_mars_yard_is_crossed_on_vision(tmp_path):
    """`.ci/run` crosses it in the full tier."""
    done = run(SCENARIO, RunOptions(out=tmp_path / "run", bar=False))
    truth = done.result.truth
    assert done.result.outcome == "reached"
    assert max(truth.waypoint_errors_m) <= 0.030
    assert truth.driven_beyond_off_track_m == 0.0
    assert all(row.met for row in done.result.expectations)
