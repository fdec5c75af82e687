"""The shipped scenarios: every fault has one, a reader learns from each, and a few of them run here.

All of them run in `longarm test scenarios -j 2`, a step of `.ci/run`.
"""

from pathlib import Path

import pytest

from docs.list_scenarios import PAGE, lesson, page
from executive.core import registry
from executive.run.fault import FAULT_KIND
from proving.inject import INSTRUMENT as FAULTS
from proving.judge import INSTRUMENT as JUDGE
from proving.suite.collect import collect
from proving.suite.run import SuiteOptions, run_suite

SCENARIOS = Path(__file__).parents[2] / "scenarios"
SURVEYED = "marsyard"  # has a test of its own, which knows when the elevation model is missing
NO_SCENARIOS = ("coverage", SURVEYED)
FILES = [path for path in sorted(SCENARIOS.rglob("*.yaml")) if path.stem not in NO_SCENARIOS]
REPRESENTATIVE = (
    "rock_on_path",
    "tracks/motor_dead",
    "markers/marker_occluded",
    "link/replayed_uplink",
    "executive/process_killed",
)


def test_the_scenarios_show_every_fault_every_kind_of_onset_and_profile_and_expect_something():
    """In one, as it takes seconds to resolve all of them; which finds every problem of a file."""
    suite = collect(FILES)
    injected = {fault.spec.name for each in suite for fault in each.scenario.of(FAULTS)}
    assert set(registry.names(FAULT_KIND)) <= injected
    faults = [fault for each in suite for fault in each.scenario.of(FAULTS)]
    onsets = {name for fault in faults for name in fault.start.model_dump(exclude_none=True)}
    profiles = {name for fault in faults if fault.profile for name in fault.profile.model_fields_set}
    assert onsets >= {"time", "progress", "waypoint", "node", "strategy", "phase", "when", "edge", "held"}
    assert profiles == {"ramp", "intermittent", "random"}
    assert [each.file.stem for each in suite] == [each.scenario.name for each in suite]
    assert [each.name for each in suite if not each.scenario.of(JUDGE).expect.outcome] == []


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_scenario_says_first_what_its_reader_learns(file):
    assert len(lesson(file)) > 40


def test_the_list_of_scenarios_is_up_to_date():
    assert PAGE.read_text() == page(), "run python docs/list_scenarios.py"


@pytest.mark.sim
@pytest.mark.slow
def test_a_few_scenarios_come_to_what_they_expect(tmp_path):
    few = collect(SCENARIOS / f"{name}.yaml" for name in REPRESENTATIVE)
    told = list(run_suite(few, SuiteOptions(tmp_path)))
    assert {row.collected.file.stem: row.verdict.message for row in told if not row.verdict.good} == {}
    assert len(told) == len(REPRESENTATIVE)
