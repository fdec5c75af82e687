"""Where each box goes: children of a composite in a column to its right, an only child underneath.

Reading order is top to bottom, nothing overlaps, and long chains of decorators stay narrow.
"""

from __future__ import annotations

from collections.abc import Iterator

from executive.report.show.boxes import Box, Tag

TITLE_PX, LINE_PX = 13.0, 10.5
TITLE_WIDTH, LINE_WIDTH = 0.67, 0.60
"""Mean width of a character, in its size: sans-serif, a little generous."""
PAD_PX, ROW_PX, HEAD_PX = 10.0, 14.0, 28.0
INDENT_PX, BELOW_PX, COLUMN_PX, GAP_PX = 26.0, 12.0, 44.0, 12.0
FRAME_PX = 12.0
TAG_ROW_PX, TAG_GAP_PX, TAGS_WIDTH_PX = 17.0, 5.0, 300.0
MARGIN_PX = 16.0


def lay_out(root: Box) -> tuple[float, float]:
    """Fill in places and sizes [px]; the whole drawing's width and height."""
    right, bottom = _place(root, MARGIN_PX + FRAME_PX, MARGIN_PX + FRAME_PX)
    return right + MARGIN_PX, bottom + MARGIN_PX


def _place(box: Box, x: float, y: float) -> tuple[float, float]:
    """Put `box` at (x, y), everything under it around it; the right and bottom edge of the lot."""
    box.width, box.height = _size(box)
    box.x, box.y = x, y
    right, bottom = x + box.width, y + box.height
    if len(box.children) == 1:
        right, bottom = _below(box, right, bottom)
    elif box.children:
        right, bottom = _beside(box, right, bottom)
    if box.frame is not None:
        right, bottom = right + FRAME_PX, bottom + FRAME_PX
    box.extent = (right, bottom)
    return right, bottom


def _below(box: Box, right: float, bottom: float) -> tuple[float, float]:
    (child,) = box.children
    inset = FRAME_PX if child.frame is not None else 0.0
    reached = _place(child, box.x + INDENT_PX + inset, box.y + box.height + BELOW_PX + inset)
    return max(right, reached[0]), max(bottom, reached[1])


def _beside(box: Box, right: float, bottom: float) -> tuple[float, float]:
    column, y = box.x + box.width + COLUMN_PX, box.y
    for child in box.children:
        inset = FRAME_PX if child.frame is not None else 0.0
        reached = _place(child, column + inset, y + inset)
        right, bottom = max(right, reached[0]), max(bottom, reached[1])
        y = reached[1] + GAP_PX
    return right, bottom


def _size(box: Box) -> tuple[float, float]:
    title = (len(box.title) + (2 if box.symbol else 0)) * TITLE_PX * TITLE_WIDTH
    lines = [len(line) * LINE_PX * LINE_WIDTH for line in (*box.lines, *box.guards)]
    width = max([title, *lines, 70.0]) + 2 * PAD_PX
    rows = len(box.lines) + len(box.guards)
    height = HEAD_PX + (rows * ROW_PX + 5.0 if rows else 0.0)
    tags = list(tag_places(box))
    if not tags:
        return width, height
    return max(width, *(x + w + PAD_PX for x, _, w, _ in tags)), height + tags[-1][1] + TAG_ROW_PX + 3.0


def tag_places(box: Box) -> Iterator[tuple[float, float, float, Tag]]:
    """Place and width of each tag [px], from the box's left edge and from under its lines; rows wrap."""
    x, y = PAD_PX, 0.0
    for tag in box.tags:
        width = len(tag.word) * LINE_PX * LINE_WIDTH + 10.0
        if x > PAD_PX and x + width > TAGS_WIDTH_PX:
            x, y = PAD_PX, y + TAG_ROW_PX
        yield x, y, width, tag
        x += width + TAG_GAP_PX
