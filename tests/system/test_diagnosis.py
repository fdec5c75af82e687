"""What is registered is weighed, recorded, told and expected; and markers count as many as there are."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from executive.cli import invoke
from executive.record import History, events
from executive.report.explain.explanation import explain
from executive.run.app import RunOptions, run

SHORT = """\
scenario: short
backend: fake
localizer: overhead
tier: geometric
time_limit: 3 h
mission:
  mission: short
  waypoints: [{x: 2.2 m, y: -0.5 m}, {x: 2.6 m, y: -0.4 m}]
"""
THREE = """\
rig: {markers: {positions_plc: [[60 mm, 45 mm, 0 m], [60 mm, -45 mm, 0 m], [-60 mm, -45 mm, 0 m]]}}
"""
WARM = """
from executive.isc import Channel, Concern, Gaussian, Hypothesis, Measured

WARMTH = Channel("warmth", "Of the motors.", "K", Gaussian(300.0, 10.0), lambda seen: Measured(390.0))
OVERHEATED = Hypothesis(
    "overheated", "The motors are hot.", {"warmth": Gaussian(400.0, 20.0)}, concerns=Concern.SIGHT
)
"""


def weights_of(folder: Path) -> list[dict[str, float]]:
    history = History.of(folder / "record.mcap")
    return [at.event.weights for at in history.all(events.HypothesesEvent)]


@pytest.fixture
def project(tmp_path: Path):
    """A folder with a scenario, and perhaps with a plug-in file; a run of it."""

    def go(scenario: str, plugin: str | None = None) -> tuple[Path, list[dict[str, float]]]:
        (tmp_path / "short.yaml").write_text(scenario)
        if plugin is not None:
            (tmp_path / "warm.py").write_text(plugin)
            (tmp_path / "longarm.yaml").write_text("plugins: [warm.py]\n")
        out = tmp_path / "run"
        finished = run(tmp_path / "short.yaml", RunOptions(out=out, bar=False, report=False))
        assert finished.defect is None
        return finished.folder, weights_of(out)

    return go


def test_a_rig_of_three_markers_stays_nominal_without_a_fault(project) -> None:
    folder, weights = project(SHORT + THREE)
    assert json.loads((folder / "result.json").read_text())["outcome"] == "reached"
    assert len(weights) > 3
    assert min(w["nominal"] for w in weights) > 0.5
    assert max(w["marker_lost"] for w in weights) < 0.05


def test_a_hypothesis_of_ones_own_is_weighed_recorded_told_and_expected(project) -> None:
    folder, weights = project(SHORT + "expect: {eventually: overheated > 0.9}\n", WARM)
    assert weights[-1]["overheated"] > 0.9
    assert sum(weights[-1].values()) == pytest.approx(1.0)
    assert next(iter(explain(folder).hypotheses)) == "overheated"
    result = json.loads((folder / "result.json").read_text())
    assert [expectation["met"] for expectation in result["expectations"]] == [True]


def test_the_weights_of_the_next_run_know_nothing_of_another_project(project, tmp_path: Path) -> None:
    _, weights = project(SHORT)
    assert "overheated" not in weights[0]


@pytest.mark.parametrize("policy", ["none", "round_robin"])
def test_a_scenario_names_its_policy(project, policy: str) -> None:
    folder, _ = project(SHORT + f"policy: {policy}\n")
    assert f"policy: {policy}" in (folder / "scenario.yaml").read_text()


def test_an_unknown_policy_is_a_problem_at_its_line(tmp_path: Path, capsys) -> None:
    (tmp_path / "short.yaml").write_text(SHORT + "policy: first_fited\n")
    assert invoke(["check", str(tmp_path / "short.yaml")]) == 1
    told = capsys.readouterr().out
    assert "short.yaml:9:9: got the unknown policy" in told
    assert 'did you mean "first_fitted"?' in told
