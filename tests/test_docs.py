"""The drawings in the documentation are those of the trees as shipped."""

from __future__ import annotations

import importlib.util
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent


def script(name: str) -> Any:
    """A script of the documentation as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_shipped_tree_is_drawn_as_it_is() -> None:
    """After changing a tree: python docs/draw_trees.py, and look at the drawing."""
    drawings = script("draw_trees").drawings()
    assert {path.name for path in drawings} == {path.name for path in (ROOT / "docs" / "trees").glob("*.svg")}
    for path, svg in drawings.items():
        assert path.read_text() == svg, f"{path.name} is out of date"


def test_the_catalogue_of_faults_is_that_of_the_faults_as_declared() -> None:
    """After changing a fault: python docs/list_faults.py."""
    catalogue = script("list_faults")
    assert catalogue.PAGE.read_text() == catalogue.page(), "faults.md is out of date"


def test_tree_page_shows_every_drawing() -> None:
    page = (ROOT / "docs" / "trees.md").read_text()
    for path in (ROOT / "docs" / "trees").glob("*.svg"):
        assert f"trees/{path.name}" in page


BLOCK = re.compile(r"^```(\w+)(?: file=(\S+))?\n(.*?)^```", re.M | re.S)


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "tutorials").glob("*.md")), ids=lambda p: p.stem)
def test_tutorial_does_what_it_says(page: Path, tmp_path: Path) -> None:
    """Every file of the page is written, every command run; each must succeed and print what it shows."""
    for language, name, text in BLOCK.findall(page.read_text()):
        if name:
            (tmp_path / name).write_text(text)
        if language == "python":
            _run([sys.executable, name], tmp_path)
        if language == "console":
            for line in text.splitlines():
                words = shlex.split(line.removeprefix("$ "))
                program = str(Path(sys.executable).with_name(words[0]))
                _run([program, *words[1:]], tmp_path)
    for tree in tmp_path.glob("*.yaml"):
        _run([str(Path(sys.executable).with_name("longarm")), "check", tree.name], tmp_path)


def _run(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
