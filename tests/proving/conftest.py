"""Short runs on the fake robot, for what works on suites of scenarios."""

from __future__ import annotations

from pathlib import Path

import pytest

SHORT = """\
scenario: short
mission:
  mission: short
  waypoints:
    - {x: 2.0 m, y: 0 m}
    - {x: 2.4 m, y: 0 m}
    - {x: 2.8 m, y: 0.1 m}
backend: fake
localizer: overhead
tier: geometric
time_limit: 3 h
expect: {outcome: reached}
"""
FROZEN = "faults:\n  - frozen_frame: {}\n    from: {node: localise, count: 3}\n    for: 10 min\n"


@pytest.fixture(scope="session")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two scenarios that pass: one without a fault, one whose cameras freeze for a while."""
    folder = tmp_path_factory.mktemp("suite")
    (folder / "plain.yaml").write_text(SHORT)
    (folder / "frozen.yaml").write_text(SHORT.replace("short", "frozen", 1) + FROZEN)
    return folder


@pytest.fixture(scope="session")
def runs(suite: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folders of the suite."""
    from executive.app import RunOptions, run

    folder = tmp_path_factory.mktemp("runs")
    for file in sorted(suite.glob("*.yaml")):
        assert run(file, RunOptions(out=folder / file.stem, bar=False)).exit_code == 0
    return folder
