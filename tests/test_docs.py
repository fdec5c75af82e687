"""The drawings in the documentation are those of the trees as shipped."""

from __future__ import annotations

import importlib.util
from pathlib import Path

ROOT = Path(__file__).parent.parent


def test_every_shipped_tree_is_drawn_as_it_is() -> None:
    """After changing a tree: python docs/draw_trees.py, and look at the drawing."""
    spec = importlib.util.spec_from_file_location("draw_trees", ROOT / "docs" / "draw_trees.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    drawings = module.drawings()
    assert {path.name for path in drawings} == {path.name for path in (ROOT / "docs" / "trees").glob("*.svg")}
    for path, svg in drawings.items():
        assert path.read_text() == svg, f"{path.name} is out of date"


def test_tree_page_shows_every_drawing() -> None:
    page = (ROOT / "docs" / "trees.md").read_text()
    for path in (ROOT / "docs" / "trees").glob("*.svg"):
        assert f"trees/{path.name}" in page
