"""The map of the house names rooms, files and functions; what it names exists, and no room is left out."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAP = (ROOT / "docs" / "architecture.md").read_text()
NAMED = re.compile(r"`((?:[a-z_]+/)+(?:[A-Za-z_]+\.py)?)(?::([A-Za-z_.]+))?`")
PLACES = sorted({(m[1], m[2] or "") for m in NAMED.finditer(MAP)})


def defined(tree: ast.AST, names: list[str]) -> bool:
    """Whether a dotted name is defined there: a class, function or constant, and what is inside a class."""
    for node in ast.iter_child_nodes(tree):
        targets = [node.target] if isinstance(node, ast.AnnAssign) else getattr(node, "targets", [])
        found = [getattr(node, "name", None), *(t.id for t in targets if isinstance(t, ast.Name))]
        if names[0] in found:
            return len(names) == 1 or defined(node, names[1:])
    return False


@pytest.mark.parametrize(("place", "name"), PLACES)
def test_what_the_map_names_is_there(place: str, name: str) -> None:
    assert (ROOT / place).exists(), f"{place} does not exist"
    if name:
        assert defined(ast.parse((ROOT / place).read_text()), name.split(".")), f"{place} defines no {name}"


@pytest.mark.parametrize("package", ["executive", "perception", "proving"])
def test_every_room_is_on_the_map(package: str) -> None:
    rooms = {f"{package}/{init.parent.name}/" for init in (ROOT / package).glob("*/__init__.py")}
    assert rooms <= {place for place, _ in PLACES}


def test_the_journeys_pass_through_functions() -> None:
    """A journey that names only files could not be held to the code."""
    journeys = MAP.split("\n## Journey")[1:]
    assert len(journeys) == 3
    assert all(len([m for m in NAMED.finditer(journey) if m[2]]) >= 8 for journey in journeys)


WRITES = re.compile(r"\.write_(?:text|bytes)\(|\.open\(\"[wax]")
ALLOWED = {
    "executive/core/files.py": "writes whole files for all others",
    "executive/record/recorder.py": "a record grows as the run goes",
    "executive/record/run_folder.py": "the lock of a folder",
    "executive/cli/importing/written.py": "drafts of its own, renamed together",
    "proving/campaign/folder.py": "a journal that grows, and a part that is renamed",
    "proving/campaign/run.py": "into the folder of a case that has just been made",
    "proving/minimise/trier.py": "into a temporary folder",
    "proving/coverage/search.py": "into a temporary folder",
}


def test_nothing_is_written_over_a_good_file_but_whole():
    """A full disk or a kill in the midst of writing leaves what was there: write beside, rename."""
    packages = ("executive", "strategies", "perception", "proving", "sim_pybullet", "longarm")
    files = {path for package in packages for path in (ROOT / package).rglob("*.py")}
    writing = {str(path.relative_to(ROOT)) for path in files if WRITES.search(path.read_text())}
    assert writing == set(ALLOWED)
