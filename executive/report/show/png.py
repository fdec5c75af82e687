"""The same drawing as PNG, painted by matplotlib from the same layout."""

from __future__ import annotations

import io
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from executive.report.show.boxes import Box
from executive.report.show.layout import (
    FRAME_PX,
    HEAD_PX,
    LINE_PX,
    PAD_PX,
    ROW_PX,
    TITLE_PX,
    lay_out,
)
from executive.report.show.palette import (
    EDGE,
    FRAME_ALTERNATIVE,
    FRAME_FILL,
    GUARD,
    PORT,
    paint,
)

DPI = 144


def png(root: Box) -> bytes:
    """The whole drawing at twice the SVG's size."""
    width, height = lay_out(root)
    scale = min(1.0, 10_000 / max(width, height))
    figure = Figure(figsize=(scale * width / 72, scale * height / 72), dpi=DPI)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0, width)
    axes.set_ylim(height, 0)
    coloured = any(box.outcome is not None for box in root.walk())
    painter = _Painter(axes, scale)
    for box in root.walk():
        painter.frame(box)
    for box in root.walk():
        painter.edges(box)
    for box in root.walk():
        painter.box(box, coloured)
    target = io.BytesIO()
    figure.savefig(target, format="png", metadata={"Software": None})
    return target.getvalue()


class _Painter:
    def __init__(self, axes: Axes, scale: float) -> None:
        self.axes, self.points = axes, scale * 1.0

    def rounded(
        self,
        x: float,
        y: float,
        size: tuple[float, float],
        radius: float,
        fill: str,
        stroke: str,
        dashed: bool,
    ) -> None:
        patch = FancyBboxPatch(
            (x, y),
            *size,
            boxstyle=f"round,pad=0,rounding_size={radius}",
            facecolor=fill,
            edgecolor=stroke,
            linewidth=1.2 * self.points,
            linestyle=(0, (4, 3)) if dashed else "solid",
        )
        self.axes.add_patch(patch)

    def frame(self, box: Box) -> None:
        if box.frame is None:
            return
        x, y = box.x - FRAME_PX, box.y - FRAME_PX
        size = (box.extent[0] - x, box.extent[1] - y)
        fill = FRAME_ALTERNATIVE if box.alternative else FRAME_FILL
        stroke = "#d9a566" if box.alternative else "#d5dbe0"
        self.rounded(x, y, size, 10, fill, stroke, box.alternative)

    def edges(self, box: Box) -> None:
        for child in box.children:
            end = child.y + HEAD_PX / 2
            if len(box.children) == 1:
                xs, ys = [box.x + 13, box.x + 13, child.x], [box.y + box.height, end, end]
            else:
                start, rail = box.x + box.width, box.x + box.width + 16
                xs, ys = [start, rail, rail, child.x], [box.y + HEAD_PX / 2, box.y + HEAD_PX / 2, end, end]
            style = (0, (4, 3)) if child.alternative else "solid"
            self.axes.plot(xs, ys, color=EDGE, linewidth=1.2 * self.points, linestyle=style)

    def box(self, box: Box, coloured: bool) -> None:
        colours = paint(box.category, box.outcome, coloured)
        radius = 13 if box.category == "leaf" else 6
        size = (box.width, box.height)
        self.rounded(box.x, box.y, size, radius, colours.fill, colours.stroke, box.alternative)
        title = f"{box.symbol} {box.title}" if box.symbol else box.title
        self.text(box.x + PAD_PX, box.y + 19, TITLE_PX, colours.text, title, weight="bold")
        y = box.y + HEAD_PX + 7
        for line in box.lines:
            self.text(box.x + PAD_PX, y, LINE_PX, PORT, line)
            y += ROW_PX
        for line in box.guards:
            self.text(box.x + PAD_PX, y, LINE_PX, GUARD, line, style="italic")
            y += ROW_PX

    def text(self, x: float, y: float, size: float, colour: str, text: str, **style: Any) -> None:
        self.axes.text(x, y, text, fontsize=size * 0.9 * self.points, color=colour, parse_math=False, **style)
