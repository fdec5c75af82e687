"""The stranger's plug-in, brought in by each way there is: entry points, a module, a project file."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ADDED = {
    "value_types": ("mass", "MASS"),
    "leaves": ("weigh_sample", "WeighSample"),
    "control_nodes": ("once", "Once"),
    "backends": ("twin", "TWIN"),
    "faults": ("hum", "HUM"),
    "strategies": ("sit_still", "STRATEGY"),
    "devices": ("thermometer", "THERMOMETER"),
    "signals": ("heat", "HEAT"),
    "channels": ("bumps", "BUMPS"),
    "hypotheses": ("rough_ground", "ROUGH"),
    "policies": ("last_first", "LAST_FIRST"),
    "instruments": ("watcher", "WATCHER"),
    "files": ("recipe", "RECIPE"),
    "reporters": ("recipe", "REPORTER"),
    "commands": ("greet", "greet"),
    "localizers": ("overhead_too", "OVERHEAD_TOO"),
}
"""Kind → the name by which the stranger adds one, and the object. A new kind joins by one line."""
WAYS = ("entry points", "module", "project")

SCENARIO = """\
scenario: outside
seed: 3
backend: twin
localizer: overhead
tier: geometric
time_limit: 1 h
watch: 3
policy: last_first
mission:
  mission: outside
  tree: weigh
  waypoints: [{x: 2.2 m, y: -0.5 m}, {x: 2.4 m, y: -0.5 m}]
faults:
  - hum: {}
    from: {time: 2 s}
expect: {strategies_not_tried: [sit_still]}
"""
TREE = """\
tree: weigh
doc: Weigh, then wait.
ports: {route: {type: Route}, full: {type: mass, default: 100 g}}
root:
  sequence:
    - weigh_sample: {scoop: 40 mm, sample: "{sample}"}
    - wait: {duration: 10 s}
      skip_if: "{sample} > {full}"
    - once: {wait: {duration: 1 s}}
"""


def install(site: Path, name: str, points: str) -> None:
    """Write the metadata of an installed distribution."""
    info = site / f"{name}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(points)


def points(module: str, added: dict[str, tuple[str, str]]) -> str:
    """Entry points, one object each."""
    return "".join(f"[longarm.{kind}]\n{n} = {module}:{o}\n" for kind, (n, o) in added.items())


@pytest.fixture(params=WAYS)
def way(request):
    """How the plug-in is brought in."""
    return request.param


@pytest.fixture
def bring_in(tmp_path, monkeypatch):
    """Brings the stranger in by one of the ways; returns the working folder with a scenario that uses it."""
    modules = set(sys.modules)

    def bring(way, text=None, added=ADDED):
        project, site = tmp_path / "project", tmp_path / "site"
        project.mkdir()
        site.mkdir()
        home = project if way == "project" else site
        (home / "stranger.py").write_text(text or (HERE / "stranger.py").read_text())
        shutil.copy(HERE / "sit_still.yaml", home)
        (project / "outside.yaml").write_text(SCENARIO)
        (project / "weigh.yaml").write_text(TREE)
        if way == "project":
            (project / "longarm.yaml").write_text("plugins: [stranger.py]\n")
        elif way == "module":
            install(site, "stranger", "[longarm.plugins]\nstranger = stranger\n")
        else:
            install(site, "stranger", points("stranger", added))
        monkeypatch.syspath_prepend(str(site))
        monkeypatch.chdir(project)
        return project

    yield bring
    for name in set(sys.modules) - modules:
        if name.startswith(("stranger", "longarm_plugins_")):
            del sys.modules[name]
