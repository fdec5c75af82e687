"""`longarm test`: verdicts, exit codes, JUnit, and nothing run when something is wrong with a file."""

from __future__ import annotations

import json
from xml.etree import ElementTree as ET

import pytest

from executive.cli import invoke

TOO_MUCH = "expect: {final_error: {below: 1 um}}\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_good_scenarios_end_with_0_and_other_yaml_is_left_alone(scenario, capsys, folder):
    scenario("one")
    scenario("two")
    (folder / "deep").mkdir()
    (folder / "deep" / "other.yaml").write_text("services: [web]\n")
    (folder / "deep" / "broken.yml").write_text("a: [\n")
    assert invoke(["test", ".", "-j", "2"]) == 0
    out = capsys.readouterr().out
    assert out.count("passed") == 3
    assert out.endswith("2 passed\n")


def test_a_failure_is_told_in_a_line_with_the_command_that_repeats_it(scenario, capsys, folder):
    scenario("one", more=TOO_MUCH)
    assert invoke(["test", "one.yaml", "--seed", "5", "--junit", "out/junit.xml"]) == 1
    head, why, repeat, counts = capsys.readouterr().out.splitlines()
    assert head.startswith("failed")
    assert "final_error below 0.001 mm: not met at" in why
    assert repeat == "    repeat: longarm run one.yaml --seed 5"
    assert counts == "1 failed"
    (case,) = ET.parse(folder / "out" / "junit.xml").iter("testcase")
    assert (case.get("name"), case.find("failure").get("type")) == ("one", "failed")
    assert invoke([*repeat.split()[2:], "--json"]) == 1, "the command repeats the failure"
    again = json.loads(capsys.readouterr().out)
    assert again["digest"] == json.loads((folder / "runs/test/one/result.json").read_text())["digest"]


def test_json_tells_each_verdict_and_nothing_else(scenario, capsys, planted):
    scenario("bad", "segfault")
    scenario("good")
    assert invoke(["test", "bad.yaml", "good.yaml", "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["counts"] == {"error": 1, "passed": 1}
    assert [row["class"] for row in told["scenarios"]] == ["sut", "ok"]


def test_every_problem_is_told_and_nothing_is_run(scenario, capsys, folder):
    scenario("good")
    scenario("one", more="sede: 3\n")
    scenario("two", more="tear: full\n")
    assert invoke(["test", ".", "nothing.yaml"]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert [line.split(":")[0] for line in errors] == ["PATH", "one.yaml", "two.yaml"]
    assert not (folder / "runs").exists()


def test_a_file_that_is_no_scenario_is_told(folder, capsys):
    (folder / "other.yaml").write_text("services: [web]\n")
    assert invoke(["test", "other.yaml"]) == 2
    assert 'other.yaml:1:1: got no "scenario"' in capsys.readouterr().err


def test_coverage_is_told_after_the_verdicts_and_can_fail_the_suite(scenario, folder, capsys):
    scenario("one")
    assert invoke(["test", "one.yaml", "--coverage", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert 0.0 < told["coverage"]["total"]["ratio"] < 0.9
    assert invoke(["test", "one.yaml", "--coverage-min", "90 %"]) == 1
    told = capsys.readouterr()
    assert "1 passed\ncoverage " in told.out
    assert "expected at least 90%" in told.err
    assert invoke(["test", "one.yaml", "--coverage-min", "much"]) == 2
