"""The shipped scenarios keep what they expect of themselves, asked in the tier that is quick enough."""

from pathlib import Path

import pytest

from executive.app import RunOptions, run
from executive.check import check_file

SCENARIOS = Path(__file__).parents[2] / "scenarios"
SURVEYED = "marsyard"  # has a test of its own, which knows when the elevation model is missing
NAMES = sorted(path.stem for path in SCENARIOS.glob("*.yaml"))


@pytest.mark.parametrize("name", [name for name in NAMES if name != SURVEYED])
def test_a_shipped_scenario_has_no_problem(name):
    assert not check_file(SCENARIOS / f"{name}.yaml")


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in NAMES if name != SURVEYED])
def test_a_shipped_scenario_comes_to_what_it_expects(tmp_path, name):
    done = run(SCENARIOS / f"{name}.yaml", RunOptions(out=tmp_path / "run", tier="geometric", bar=False))
    unmet = [row["text"] for row in done.result["expectations"] if not row["met"]]
    assert unmet == []
    assert done.exit_code == 0
    assert all(row["fired"] for row in done.result["faults"])
