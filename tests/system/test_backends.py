"""Backends and strategies keep their contracts; the contract's own example tree drives a mission."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from executive.cli import invoke
from executive.config.backends import BACKEND_KIND, BackendRequest, BackendSpec
from executive.core import registry
from executive.core.rig import RigCalibration
from executive.core.types import Point, Segment
from executive.pool import Strategy
from executive.testing import check_backend, check_strategy
from executive.tree.load import load_tree
from executive.tree.nodes.base import Direction
from executive.tree.strategies import load_strategies, strategy_trees
from tests.system.bench import Setting

ROOT = Path(__file__).resolve().parents[2]
ROUTE = (Segment(Point(2.2, -0.5), Point(2.8, -0.4), 0.03, 0.25, 0.03),)
SHIPPED = tuple(strategy.name for strategy in load_strategies())

CONTRACT_TREE = """\
tree: traverse_segment
doc: Turn towards the end of the segment, verify precisely, then trek to its tolerance zone.
ports: {segment: {type: Segment, direction: in}, pose: {type: PoseEstimate, direction: inout}}
root:
  recover:                                  # the pool answers whatever fails inside
    attempts: 5
    child:
      sequence:
        - rotate_towards: {target: "{segment.end}", pose: "{pose}", tolerance: 0.5 deg}
        - localise: {quality: precise, pose: "{pose}"}
        - trek_to: {target: "{segment.end}", pose: "{pose}", within: "{segment.tolerance}"}
          while: "abs({pose.cross_track}) < {segment.off_track}"
"""


@pytest.mark.sim
@pytest.mark.parametrize(
    ("name", "tier"), [("fake", "geometric"), ("pybullet", "geometric"), ("pybullet", "full")]
)
def test_a_backend_keeps_every_promise(name: str, tier: str) -> None:
    spec = registry.get(BACKEND_KIND, name)
    assert isinstance(spec, BackendSpec)
    check_backend(spec, BackendRequest(spec.world_model(), ROUTE, 3, tier, RigCalibration(), None, 1.0))


def strategy(name: str) -> Strategy:
    return next(s for s in load_strategies() if s.name == name)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_strategy_keeps_every_promise(name: str) -> None:
    check_strategy(strategy(name))


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_strategy_has_a_tree_of_its_name(name: str) -> None:
    tree = load_tree(strategy(name).tree)
    assert tree.name == name
    assert {port.name for port in tree.ports if port.direction is not Direction.OUT} <= {"pose", "segment"}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder whose own traverse_segment, the contract's, comes before the installed one."""
    shutil.copytree(ROOT / "trees", tmp_path / "trees")
    (tmp_path / "trees" / "traverse_segment.yaml").write_text(CONTRACT_TREE)
    (tmp_path / "short.yaml").write_text(Setting().text())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_tree_of_the_contract_loads_and_draws_with_every_strategy_that_fits(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["check", "trees/traverse_segment.yaml", "short.yaml"]) == 0
    tree = load_tree("traverse_segment")
    assert {port.name for port in tree.ports} == {"segment", "pose"}
    assert set(strategy_trees(load_strategies())) >= set(SHIPPED)
    assert invoke(["show", "traverse_segment"]) == 0
    drawn = capsys.readouterr().out
    assert all(name in drawn for name in SHIPPED)


def test_the_tree_of_the_contract_drives_a_mission(folder: Path) -> None:
    assert invoke(["run", "short.yaml", "--out", "out", "--quiet"]) == 0
    result = json.loads((folder / "out" / "result.json").read_text())
    assert result["outcome"] == "reached"
    assert result["waypoints"] == {"total": 12, "reached": 12}


def test_the_contracts_tree_is_recovered_by_the_pool_too(folder: Path) -> None:
    noisy = 'world={"pixel_sigma": 20.0}'
    assert invoke(["run", "short.yaml", "--out", "out", "--quiet", "--set", noisy]) in (0, 1)
    result = json.loads((folder / "out" / "result.json").read_text())
    assert result["outcome"] in ("reached", "help")
    assert result["strategies"]
    assert {row["name"] for row in result["strategies"]} <= set(SHIPPED)
