"""Draws every shipped tree and strategy into docs/trees/. Run it when a tree changes; a test says when.

python docs/draw_trees.py
"""

from __future__ import annotations

from pathlib import Path

from executive.report.show import draw
from executive.tree.load import load_tree

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "trees"


def drawings() -> dict[Path, str]:
    """The drawing of each shipped tree by the file it belongs in."""
    files = sorted((ROOT / "trees").glob("*.yaml")) + sorted((ROOT / "strategies").glob("*.yaml"))
    drawn = {FOLDER / f"{file.stem}.svg": draw(load_tree(file), "svg") for file in files}
    return {path: svg for path, svg in drawn.items() if isinstance(svg, str)}


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for path, svg in drawings().items():
        path.write_text(svg)
