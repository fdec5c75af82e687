"""The commands of Longarm work for this robot as they are."""

from __future__ import annotations

from pathlib import Path

import pytest
from executive.cli.command_line import invoke

HOME = Path(__file__).parents[1]
SCENARIOS = HOME / "yard_robot" / "scenarios"


@pytest.fixture(autouse=True)
def at_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the example's folder, whose `longarm.yaml` names the plug-in."""
    monkeypatch.chdir(HOME)


@pytest.fixture(scope="module")
def drained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folder of a mission whose battery was drained."""
    out = tmp_path_factory.mktemp("runs") / "drained"
    scenario = str(SCENARIOS / "battery_drain.yaml")
    assert invoke(["run", scenario, "--seed", "0", "--out", str(out), "--quiet"]) == 0
    return out


def test_every_file_of_the_yard_checks():
    files = [str(file) for file in sorted((HOME / "yard_robot").rglob("*.yaml"))]
    assert invoke(["check", *files]) == 0


def test_show_draws_the_control_node(capsys):
    assert invoke(["show", "yard_segment"]) == 0
    assert "▮ while_charged" in capsys.readouterr().out


def test_show_draws_a_run_with_its_outcomes(drained, capsys):
    assert invoke(["show", str(drained)]) == 0
    assert "recharge_wait" in capsys.readouterr().out


def test_report_has_the_panels_of_the_battery(drained):
    assert invoke(["report", str(drained)]) == 0
    report = (drained / "report.html").read_text()
    assert "battery: charge" in report
    assert "battery: power" in report


def test_explain_says_why_the_robot_recharged(drained, capsys):
    assert invoke(["explain", str(drained), "--at", "2 min"]) == 0
    said = capsys.readouterr().out
    assert "recharge_wait  running" in said
    assert "battery_low" in said


def test_coverage_counts_the_hypothesis_and_its_strategy(drained, capsys):
    assert invoke(["coverage", str(drained), "--json"]) == 0
    shown = capsys.readouterr().out
    assert "battery_low" in shown
    assert "recharge" in shown
