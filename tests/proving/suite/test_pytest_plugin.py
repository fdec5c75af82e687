"""pytest collects the same files with the same verdicts."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def run(tmp_path):
    """Runs pytest in a project of its own."""

    def pytest_in(*arguments, ini=""):
        (tmp_path / "pytest.ini").write_text(f"[pytest]\nfilterwarnings = error\n{ini}")
        command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-rA", *arguments]
        env = os.environ | {"PYTHONPATH": str(ROOT)}
        return subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, check=False)

    return pytest_in


def test_scenarios_pass_and_fail_with_a_terse_message_in_parallel(run, scenario):
    scenario("good")
    scenario("bad", more="expect: {final_error: {below: 1 um}}\n")
    done = run("bad.yaml", "good.yaml", "-n", "2")
    assert "1 failed, 1 passed" in done.stdout, done.stdout + done.stderr
    assert "final_error below 0.001 mm: not met at" in done.stdout
    assert "repeat: longarm run" in done.stdout
    assert "Traceback" not in done.stdout


def test_folders_are_collected_only_where_the_project_says_so(run, tmp_path, scenario):
    (tmp_path / "scenarios").mkdir()
    scenario("one").rename(tmp_path / "scenarios" / "one.yaml")
    scenario("other")
    assert "no tests ran" in run(".").stdout
    done = run("scenarios", "--collect-only", "-q", ini="longarm_scenarios = scenarios\n")
    assert "scenarios/one.yaml::one" in done.stdout, done.stdout + done.stderr


def test_a_scenario_with_problems_is_a_collection_error_that_tells_them(run, scenario):
    scenario("bad", more="sede: 3\n")
    done = run("bad.yaml")
    assert done.returncode == 2
    assert 'bad.yaml:9:1: got the unknown key "sede"' in done.stdout
