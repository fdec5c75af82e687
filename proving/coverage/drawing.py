"""The covered trees as drawings: every node with its outcomes, painted by whether they were seen."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from html import escape
from pathlib import Path

from executive.core.files import write_whole
from executive.report.figure import counted
from executive.report.show.boxes import Box, Tag, boxes
from executive.report.show.palette import COVERAGE
from executive.report.show.svg import svg
from executive.tree.spec import NodeSpec, TreeSpec
from proving.coverage.coverage import Coverage
from proving.coverage.items import Item
from proving.coverage.table import PLURALS, headline

PAINTS = {"success": "success", "running": "running", "halted": "running"}


def write(coverage: Coverage, file: Path) -> None:
    """One page for all trees; with the suffix .svg the first tree only."""
    if file.suffix == ".svg":
        write_whole(file, _drawing(coverage, next(iter(coverage.universe.trees.values()))))
    else:
        write_whole(file, page(coverage))


def page(coverage: Coverage) -> str:
    """A self-contained HTML page: shares, a drawing a tree file, what else was not seen."""
    trees = "".join(
        f"<section><h2>{escape(tree.name)}</h2><p>{escape(tree.doc)}</p>"
        f'<div class="drawing">{_drawing(coverage, tree)}</div></section>'
        for tree in coverage.universe.trees.values()
    )
    rows = "".join(_row(kind, coverage) for kind in PLURALS)
    legend = "".join(
        f'<li><i style="background:{colours.fill};border-color:{colours.stroke}"></i>{escape(name)}</li>'
        for name, colours in COVERAGE.items()
    )
    return PAGE.format(title=escape(headline(coverage)), rows=rows, legend=legend, trees=trees)


def _row(kind: str, coverage: Coverage) -> str:
    share = coverage.share(kind)
    missing = [f"{i.name}: {i.word}" for i in coverage.holes(kind)] if kind != "node" else []
    return (
        f"<tr><th>{PLURALS[kind]}</th><td><meter value='{share.ratio:.4f}'></meter></td>"
        f"<td>{share.ratio:.1%}</td><td>{share.covered} of {share.of}, {share.excused} excused</td>"
        f"<td>{escape(', '.join(missing))}</td></tr>"
    )


def _drawing(coverage: Coverage, tree: TreeSpec) -> str:
    root = boxes(replace(tree, root=_folded(tree.root)))
    for box in root.walk():
        words = coverage.universe.words.get(box.path, [])
        _mark(box, [Item("node", box.path, word) for word in words], coverage)
    return svg(root)


def _folded(node: NodeSpec) -> NodeSpec:
    """Trees used as nodes stand as one box; they have their own drawing."""
    return replace(node, tree=None, children=tuple(_folded(child) for child in node.children))


def _mark(box: Box, items: list[Item], coverage: Coverage) -> None:
    if not items:
        return
    seen = [coverage.covers(item) for item in items]
    fine = [known or item in coverage.excused for item, known in zip(items, seen, strict=True)]
    box.outcome = "covered" if all(fine) else "partly covered" if any(seen) else "not covered"
    box.tags = tuple(_tags(items, coverage))


def _tags(items: list[Item], coverage: Coverage) -> Iterator[Tag]:
    for item in items:
        count = coverage.seen.count[item]
        if count:
            tip = f"{counted(count, 'time')}, first in {coverage.seen.first[item]}"
            yield Tag(item.word, PAINTS.get(item.word, "failure"), tip)
        else:
            yield Tag(item.word, None, coverage.excused.get(item, "not seen"))


PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font: 15px/1.5 Inter, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; color: #2a3138; margin: 2rem; }}
h1 {{ font-size: 1.4rem; margin: 0 0 1rem; }} h2 {{ font-size: 1.1rem; margin: 2rem 0 0; }}
p {{ max-width: 46rem; margin: .2rem 0 .8rem; color: #515b64; }}
table {{ border-collapse: collapse; font-size: .9rem; }}
th, td {{ text-align: left; padding: .2rem .9rem .2rem 0; vertical-align: top; font-weight: normal; }}
ul {{ list-style: none; display: flex; gap: 1.2rem; padding: 0; font-size: .85rem; }}
i {{ display: inline-block; width: 1.1em; height: .8em; border: 1.5px solid; border-radius: 3px;
  margin-right: .4em; }}
.drawing {{ overflow: auto; }}
</style>
</head>
<body>
<h1>{title}</h1>
<table>{rows}</table>
<ul>{legend}<li>tags: outcomes seen; dashed: not seen, or excused (the tip says why)</li></ul>
{trees}
</body>
</html>
"""
