"""Scenarios on the fake robot, and faults that break the process they run in."""

from __future__ import annotations

import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from executive.run.app import RunOptions, run
from proving.engine import Case, Limits

PLANTED = Path(__file__).with_name("planted")
NAMES = (
    "segfault",
    "hang",
    "eat_memory",
    "fill_disk",
    "raise_error",
    "exit_at_once",
    "outer_kill",
    "harmless",
)
SHORT = """\
scenario: {name}
backend: fake
localizer: overhead
tier: geometric
time_limit: 3 h
mission:
  mission: short
  waypoints: [{{x: 2.2 m, y: -0.5 m}}, {{x: 2.4 m, y: -0.5 m}}]
"""


@pytest.fixture
def planted(tmp_path, monkeypatch):
    """Makes the planted faults known, to this process and to every one it starts."""
    known = {point.name for point in entry_points(group="longarm.faults")}
    info = tmp_path / "plugins" / "planted-0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: planted\nVersion: 0\n")
    lines = [f"{name} = planted:{name.upper()}" for name in NAMES]
    lines += [] if "process_killed" in known else ["process_killed = planted:PLANTED_KILL"]
    (info / "entry_points.txt").write_text("[longarm.faults]\n" + "\n".join(lines) + "\n")
    for folder in (PLANTED, info.parent):
        monkeypatch.syspath_prepend(str(folder))
    yield NAMES
    sys.modules.pop("planted", None)


@pytest.fixture
def scenario(tmp_path):
    """Writes a scenario of some ten ticks, with a fault and more lines if asked; the file."""

    def write(name="short", fault=None, more=""):
        text = SHORT.format(name=name) + more
        if fault is not None:
            text += f"faults:\n  - {fault}: {{}}\n    from: {{time: 20 s}}\n"
        file = tmp_path / f"{name}.yaml"
        file.write_text(text)
        return file

    return write


@pytest.fixture
def case(tmp_path, scenario):
    """A case of such a scenario, with limits for tests."""

    def make(name="short", fault=None, wall_s=20.0, memory_bytes=300 * 2**20, **more):
        file = scenario(name, fault, more.pop("text", ""))
        return Case(name, file, tmp_path / "out" / name, limits=Limits(wall_s, memory_bytes), **more)

    return make


TOUR = """\
scenario: {name}
mission:
  mission: short
  waypoints:
    - {{x: 2.0 m, y: 0 m}}
    - {{x: 2.4 m, y: 0 m}}
    - {{x: 2.8 m, y: 0.1 m}}
backend: fake
localizer: overhead
tier: geometric
time_limit: 3 h
expect: {{outcome: reached}}
"""
FROZEN = "faults:\n  - frozen_frame: {}\n    from: {node: localise, count: 3}\n    for: 10 min\n"


@pytest.fixture(scope="session")
def suite(tmp_path_factory):
    """A folder with two scenarios that pass: one without a fault, one whose cameras freeze for a while."""
    folder = tmp_path_factory.mktemp("suite")
    (folder / "plain.yaml").write_text(TOUR.format(name="plain"))
    (folder / "frozen.yaml").write_text(TOUR.format(name="frozen") + FROZEN)
    return folder


@pytest.fixture(scope="session")
def runs(suite, tmp_path_factory):
    """The run folders of that suite."""
    folder = tmp_path_factory.mktemp("runs")
    for file in sorted(suite.glob("*.yaml")):
        options = RunOptions(out=folder / file.stem, bar=False, report=False)
        assert run(file, options).exit_code == 0
    return folder
