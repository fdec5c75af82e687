"""Two trees in one process share nothing; a tree's values can be put away and taken out again."""

from __future__ import annotations

import ast
import pickle
from pathlib import Path

import pytest
from py_trees.common import Status

from executive.tree.nodes.base import Slot
from tests.system.bench import Diary, Setting, prepare

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("executive", "strategies", "perception", "sim_pybullet", "proving")
NOISY, PLAIN = Setting(pixel_sigma=20.0), Setting()


class Ticking:
    """A tree on its own fake robot, ticked from outside; what it held after each tick."""

    def __init__(self, setting: Setting, folder: Path) -> None:
        self.run, self.built, self.backend = prepare(setting, folder, Diary())
        self.seen: list[str] = []

    def tick(self) -> None:
        self.run.services.classification.tracker.sense(self.backend.devices)
        self.built.root.tick_once()
        tip = self.built.root.tip()
        values = sorted((key, str(value)) for key, value in self.built.store.values.items())
        self.seen.append(f"{tip.name if tip else None} {values}")
        if self.built.root.status is Status.RUNNING:
            self.backend.advance()

    def close(self) -> None:
        self.run.recorder.close()


def alone(setting: Setting, folder: Path, ticks: int) -> list[str]:
    one = Ticking(setting, folder)
    for _ in range(ticks):
        one.tick()
    one.close()
    return one.seen


@pytest.mark.parametrize("other", [NOISY, PLAIN], ids=["of another setting", "the same built twice"])
def test_trees_ticked_in_turn_behave_as_each_alone(tmp_path: Path, other: Setting) -> None:
    folders = [tmp_path / name for name in ("a", "b", "c", "d")]
    for folder in folders:
        folder.mkdir()
    first, second = Ticking(PLAIN, folders[0]), Ticking(other, folders[1])
    for _ in range(200):
        first.tick()
        second.tick()
    first.close()
    second.close()
    assert first.built.store is not second.built.store
    assert first.seen == alone(PLAIN, folders[2], 200)
    assert second.seen == alone(other, folders[3], 200)
    assert len(set(first.seen)) > 20
    if other != PLAIN:
        assert first.seen != second.seen


def test_no_value_object_that_can_change_is_in_two_stores(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    first, second = Ticking(PLAIN, tmp_path), Ticking(PLAIN, tmp_path / "b")
    for tree in (first, second):
        for _ in range(60):
            tree.tick()
        tree.close()
    mine = {id(v) for v in first.built.store.values.values() if v.__hash__ is None}
    assert not mine & {id(v) for v in second.built.store.values.values()}


def test_a_store_survives_pickling_in_mid_run(tmp_path: Path) -> None:
    tree = Ticking(PLAIN, tmp_path)
    for _ in range(80):
        tree.tick()
    store = tree.built.store
    frozen = pickle.dumps(store)
    kept = {key: str(value) for key, value in store.values.items()}
    assert {key.rpartition(":")[2] for key in kept} >= {"route", "pose", "segment", "leg"}
    for _ in range(80):
        tree.tick()
    assert {key: str(value) for key, value in store.values.items()} != kept
    restored = pickle.loads(frozen)
    assert {key: str(value) for key, value in restored.values.items()} == kept
    assert Slot(restored, "navigate:route").read() == store.values["navigate:route"]
    tree.close()


def blackboards(source: str) -> list[int]:
    """Lines that name py_trees' process-wide blackboard, or anything that keeps its values there."""
    banned = {"Blackboard", "blackboard", "attach_blackboard_client", "blackboard_exchange"}
    lines = []
    for node in ast.walk(ast.parse(source)):
        names: list[str] = []
        if isinstance(node, ast.Attribute):
            names = [node.attr]
        elif isinstance(node, ast.Name):
            names = [node.id]
        elif isinstance(node, ast.ImportFrom):
            names = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = [part for alias in node.names for part in alias.name.split(".")]
        if banned & set(names):
            lines.append(node.lineno)
    return lines


def test_no_package_touches_the_blackboard_of_py_trees() -> None:
    files = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    assert len(files) > 100
    assert [f"{path}:{line}" for path in files for line in blackboards(path.read_text())] == []


@pytest.mark.parametrize(
    "offence",
    [
        "from py_trees.blackboard import Client",
        "from py_trees import blackboard",
        "import py_trees.blackboard",
        "import py_trees\nx = py_trees.blackboard.Blackboard.storage",
        "self.attach_blackboard_client()",
    ],
)
def test_a_planted_use_of_the_blackboard_is_found(offence: str) -> None:
    assert blackboards(offence)
