"""Formats made of text: an outline for terminals, Graphviz, Mermaid."""

from __future__ import annotations

import json
from collections.abc import Iterator

from executive.report.show.boxes import Box
from executive.report.show.palette import paint

MARKS = {"success": "✓", "failure": "✗", "running": "▶"}


def unicode(root: Box) -> str:
    """The tree as an outline; strategies that the pool may choose have a dotted rail."""
    return "\n".join(_outline(root, "", "", "")) + "\n"


def _outline(box: Box, lead: str, branch: str, below: str) -> Iterator[str]:
    mark = f"{MARKS.get(box.outcome, '·')} " if box.outcome else ""
    symbol = f"{box.symbol} " if box.symbol else ""
    details = "  ".join((*(() if box.category == "tree" else box.lines), *(f"[{g}]" for g in box.guards)))
    yield f"{lead}{branch}{mark}{symbol}{box.title}" + (f"  {details}" if details else "")
    for index, child in enumerate(box.children):
        last = index == len(box.children) - 1
        joint = ("└┄ " if last else "├┄ ") if child.alternative else ("└─ " if last else "├─ ")
        yield from _outline(child, lead + below, joint, "   " if last else "│  ")


def dot(root: Box) -> str:
    """Graphviz; node names are paths."""
    coloured = any(box.outcome is not None for box in root.walk())
    lines = [
        "digraph tree {",
        '  graph [rankdir=LR, ordering=out, fontname="Helvetica"];',
        '  node [shape=box, style="rounded,filled", fontname="Helvetica", fontsize=11];',
    ]
    for box in root.walk():
        colours = paint(box.category, box.outcome, coloured)
        label = "\n".join((f"{box.symbol} {box.title}".strip(), *box.lines, *box.guards))
        style = ', style="rounded,filled,dashed"' if box.alternative else ""
        lines.append(
            f"  {_quoted(box.path)} [label={_quoted(label)}, "
            f'fillcolor="{colours.fill}", color="{colours.stroke}"{style}];'
        )
    for box in root.walk():
        for child in box.children:
            style = " [style=dashed]" if child.alternative else ""
            lines.append(f"  {_quoted(box.path)} -> {_quoted(child.path)}{style};")
    return "\n".join([*lines, "}", ""])


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def mermaid(root: Box) -> str:
    """A Mermaid flow chart, as code hosts draw it in Markdown."""
    coloured = any(box.outcome is not None for box in root.walk())
    ids = {id(box): f"n{index}" for index, box in enumerate(root.walk())}
    lines = ["flowchart LR"]
    for box in root.walk():
        label = "<br/>".join((f"{box.symbol} {box.title}".strip(), *box.lines, *box.guards))
        colours = paint(box.category, box.outcome, coloured)
        lines.append(f"  {ids[id(box)]}[{_mermaid_text(label)}]")
        lines.append(
            f"  style {ids[id(box)]} fill:{colours.fill},stroke:{colours.stroke},color:{colours.text}"
        )
    for box in root.walk():
        for child in box.children:
            arrow = "-.->" if child.alternative else "-->"
            lines.append(f"  {ids[id(box)]} {arrow} {ids[id(child)]}")
    return "\n".join([*lines, ""])


def _mermaid_text(text: str) -> str:
    for sign, entity in (("#", "#35;"), ('"', "#quot;"), ("{", "#123;"), ("}", "#125;")):
        text = text.replace(sign, entity)
    return json.dumps(text, ensure_ascii=False)
