"""Colours of the drawings: one hue a kind of node, restrained; outcomes stronger than kinds."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Paint:
    """Fill and stroke of a box, and the colour of its title."""

    fill: str
    stroke: str
    text: str


KINDS = {
    "control": Paint("#e8eef7", "#4a6fa5", "#2b4668"),
    "decorator": Paint("#f3ecf8", "#8a63a8", "#553a6b"),
    "recovery": Paint("#fdf0e1", "#c9802f", "#7d4c12"),
    "leaf": Paint("#e6f4f0", "#3c8d7a", "#1f5548"),
    "tree": Paint("#ffffff", "#5c6670", "#2a3138"),
}
OUTCOMES = {
    "success": Paint("#dff2e1", "#2e8540", "#1a5428"),
    "failure": Paint("#fbe2df", "#c0392b", "#7d1f15"),
    "running": Paint("#e0edfb", "#2471c8", "#124680"),
}
COVERAGE = {
    "covered": OUTCOMES["success"],
    "partly covered": Paint("#fdf3dc", "#c9962f", "#6f4e0c"),
    "not covered": OUTCOMES["failure"],
}
UNVISITED = Paint("#f7f8f8", "#c5cbd0", "#8a939b")
EDGE, FAINT, PORT, GUARD = "#8d979f", "#d3d8dc", "#515b64", "#8a5a00"
FRAME_FILL, FRAME_ALTERNATIVE = "#f6f8fa", "#fffaf3"


def paint(category: str, outcome: str | None, coloured: bool) -> Paint:
    """How to paint a node: by its outcome where the drawing shows a run, else by its kind."""
    if outcome is not None:
        return (OUTCOMES | COVERAGE).get(outcome, UNVISITED)
    return UNVISITED if coloured else KINDS.get(category, KINDS["leaf"])
