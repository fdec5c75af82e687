"""Drawings of a tree, made from its specification alone; coloured where the outcomes of a run are given."""

from __future__ import annotations

from collections.abc import Mapping

from executive.report.show.boxes import boxes
from executive.report.show.groot import groot
from executive.report.show.page import page
from executive.report.show.svg import svg
from executive.report.show.text import dot, mermaid, unicode
from executive.tree.spec import TreeSpec

FORMATS = ("unicode", "dot", "svg", "png", "mermaid", "html", "groot")


def draw(
    tree: TreeSpec,
    format: str = "unicode",
    strategies: Mapping[str, TreeSpec] | None = None,
    outcomes: Mapping[str, str] | None = None,
) -> str | bytes:
    """The tree in one of FORMATS; bytes for png, text for the others.

    `strategies` are drawn dashed under each `recover`; `outcomes` maps paths to success, failure or running.
    """
    if format == "groot":
        return groot(tree, strategies)
    root = boxes(tree, strategies, outcomes)
    match format:
        case "unicode":
            return unicode(root)
        case "dot":
            return dot(root)
        case "svg":
            return svg(root)
        case "mermaid":
            return mermaid(root)
        case "html":
            return page(root, tree.doc)
        case "png":
            from executive.report.show.png import png  # matplotlib takes half a second to import

            return png(root)
    raise ValueError(f"got the format {format!r}, expected one of {', '.join(FORMATS)}")
