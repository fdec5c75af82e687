"""The drawing as one HTML page that opens offline."""

from __future__ import annotations

from html import escape

from executive.report.show.boxes import Box
from executive.report.show.palette import GUARD, KINDS, OUTCOMES
from executive.report.show.svg import svg


def page(root: Box, doc: str) -> str:
    """The SVG with a title, the tree's documentation and a legend."""
    coloured = any(box.outcome is not None for box in root.walk())
    paints = OUTCOMES if coloured else KINDS
    legend = "".join(
        f'<li><i style="background:{colours.fill};border-color:{colours.stroke}"></i>{escape(name)}</li>'
        for name, colours in paints.items()
    )
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{escape(root.title)}</title>
<style>
body {{ font: 15px/1.5 Inter, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; color: #2a3138; margin: 2rem; }}
h1 {{ font-size: 1.4rem; margin: 0; }} p {{ max-width: 46rem; margin: .3rem 0 1rem; color: #515b64; }}
ul {{ list-style: none; display: flex; flex-wrap: wrap; gap: 1.2rem; padding: 0; font-size: .85rem; }}
i {{ display: inline-block; width: 1.1em; height: .8em; border: 1.5px solid; border-radius: 3px;
  margin-right: .4em; }}
.drawing {{ overflow: auto; }} em {{ color: {GUARD}; }}
</style>
</head>
<body>
<h1>{escape(root.title)}</h1>
<p>{escape(doc)}</p>
<ul>{legend}<li><em>guards</em></li><li>dashed: strategies the pool may choose</li></ul>
<div class="drawing">
{svg(root)}</div>
</body>
</html>
"""
