"""The drawing as self-contained SVG: own layout, no scripts, no style sheet that could clash in a page."""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import escape, quoteattr

from executive.report.show.boxes import Box
from executive.report.show.layout import (
    FRAME_PX,
    HEAD_PX,
    LINE_PX,
    PAD_PX,
    ROW_PX,
    TITLE_PX,
    lay_out,
    tag_places,
)
from executive.report.show.palette import (
    EDGE,
    FRAME_ALTERNATIVE,
    FRAME_FILL,
    GUARD,
    PORT,
    paint,
)

FONT = "Inter, 'Segoe UI', Roboto, 'Helvetica Neue', 'DejaVu Sans', Arial, sans-serif"


def svg(root: Box) -> str:
    """The whole drawing."""
    width, height = lay_out(root)
    coloured = any(box.outcome is not None for box in root.walk())
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" font-family="{FONT}" role="img">',
        f"<title>{escape(root.title)}</title>",
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#ffffff"/>',
        *_frames(root),
        *_edges(root),
    ]
    for box in root.walk():
        parts.extend(_box(box, coloured))
    return "\n".join([*parts, "</svg>", ""])


def _frames(root: Box) -> Iterator[str]:
    for box in root.walk():
        if box.frame is None:
            continue
        x, y = box.x - FRAME_PX, box.y - FRAME_PX
        width, height = box.extent[0] - x, box.extent[1] - y
        fill = FRAME_ALTERNATIVE if box.alternative else FRAME_FILL
        dash = ' stroke-dasharray="5 4"' if box.alternative else ""
        stroke = "#d9a566" if box.alternative else "#d5dbe0"
        yield (
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" rx="10" fill="{fill}" '
            f'stroke="{stroke}"{dash}/>'
        )


def _edges(root: Box) -> Iterator[str]:
    for box in root.walk():
        for child in box.children:
            dash = ' stroke-dasharray="5 4"' if child.alternative else ""
            path = _below(box, child) if len(box.children) == 1 else _beside(box, child)
            yield f'<path d="{path}" fill="none" stroke="{EDGE}" stroke-width="1.4"{dash}/>'


def _below(box: Box, child: Box) -> str:
    x, y, end = box.x + 13, box.y + box.height, child.y + HEAD_PX / 2
    return f"M{x:.1f},{y:.1f} V{end - 6:.1f} Q{x:.1f},{end:.1f} {x + 6:.1f},{end:.1f} H{child.x:.1f}"


def _beside(box: Box, child: Box) -> str:
    x, y = box.x + box.width, box.y + HEAD_PX / 2
    end = child.y + HEAD_PX / 2
    rail = x + 16
    if abs(end - y) < 12:
        return f"M{x:.1f},{y:.1f} H{rail:.1f} L{rail + 6:.1f},{end:.1f} H{child.x:.1f}"
    return (
        f"M{x:.1f},{y:.1f} H{rail - 6:.1f} Q{rail:.1f},{y:.1f} {rail:.1f},{y + 6:.1f} "
        f"V{end - 6:.1f} Q{rail:.1f},{end:.1f} {rail + 6:.1f},{end:.1f} H{child.x:.1f}"
    )


def _box(box: Box, coloured: bool) -> Iterator[str]:
    colours = paint(box.category, box.outcome, coloured)
    dash = ' stroke-dasharray="5 4"' if box.alternative else ""
    tip = box.path + (f": {box.outcome}" if box.outcome else "")
    radius = 14 if box.category == "leaf" else 6
    yield f"<g data-path={quoteattr(box.path)}><title>{escape(tip)}</title>"
    yield (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.width:.1f}" height="{box.height:.1f}" '
        f'rx="{radius}" fill="{colours.fill}" stroke="{colours.stroke}" stroke-width="1.5"{dash}/>'
    )
    title = f"{box.symbol} {box.title}" if box.symbol else box.title
    yield _text(box.x + PAD_PX, box.y + 19, TITLE_PX, colours.text, title, ' font-weight="600"')
    y = box.y + HEAD_PX + 7
    for line, colour, style in (
        *((line, PORT, "") for line in box.lines),
        *((line, GUARD, ' font-style="italic"') for line in box.guards),
    ):
        yield _text(box.x + PAD_PX, y, LINE_PX, colour, line, style)
        y += ROW_PX
    yield from _tags(box, y - 7 if box.lines or box.guards else box.y + HEAD_PX)
    yield "</g>"


def _tags(box: Box, top: float) -> Iterator[str]:
    for dx, dy, width, tag in tag_places(box):
        colours = paint(box.category, tag.outcome, coloured=True)
        dash = "" if tag.outcome else ' stroke-dasharray="3 2"'
        x, y = box.x + dx, top + dy
        yield (
            f'<g><title>{escape(tag.tip)}</title><rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" '
            f'height="14" rx="7" fill="{colours.fill}" stroke="{colours.stroke}"{dash}/>'
        )
        yield _text(x + 5, y + 10.5, LINE_PX, colours.text, tag.word, "") + "</g>"


def _text(x: float, y: float, size: float, colour: str, text: str, style: str) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}"{style} '
        f'xml:space="preserve">{escape(text)}</text>'
    )
