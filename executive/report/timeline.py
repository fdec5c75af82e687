"""Who did what when: leaves, strategies, faults, and the weights of the hypotheses, on one time axis."""

from __future__ import annotations

import numpy as np

from executive.core.types import Array
from executive.record.events import HypothesesEvent
from executive.record.history import At
from executive.report import palette, svg
from executive.report.axes import Chart, Scale, legend, thinned, time_axis, timed
from executive.report.figure import Figure, duration
from executive.report.gather import Run
from executive.report.spans import Span, fault_spans, leaf_spans, short_names, strategy_spans

_WIDTH, _LEFT, _ROW, _MOST_ROWS = 1100.0, 200.0, 20.0, 24
_COLOURS = {**palette.STATUS, "strategy": palette.STRATEGY, "fault": palette.FAULT}


def timeline(run: Run) -> Figure | None:
    """Swimlanes of leaves, strategies and faults; None where nothing was recorded."""
    leaves = dict(list(leaf_spans(run).items())[:_MOST_ROWS])
    names = short_names(list(leaves))
    groups = [
        ("leaves", {names[path]: (path, spans) for path, spans in leaves.items()}),
        ("strategies", {name: (name, spans) for name, spans in strategy_spans(run).items()}),
        ("faults", {name: (name, spans) for name, spans in fault_spans(run).items()}),
    ]
    groups = [(title, rows) for title, rows in groups if rows]
    if not groups:
        return None
    time = Scale(0.0, run.end_s, _LEFT, _WIDTH - 8)
    body, y = [], 8.0
    for title, rows in groups:
        y += 16
        body.append(svg.text(8, y - 3, title, class_="axis"))
        for name, (path, spans) in rows.items():
            body.append(_row(time, y, name, path, spans))
            y += _ROW
    grid = time_axis(time, 10, y + 2)
    drawn = svg.drawing(_WIDTH, y + 24, [grid, *body], aria_label="Timeline", **timed(time, 10, y + 2))
    words = [
        ("solid", palette.GOOD, "ended in success"),
        ("solid", palette.BAD, "ended in failure"),
        ("solid", palette.STATUS["invalid"], "interrupted"),
        ("solid", palette.BUSY, "still under way"),
    ]
    caption = (
        "Each row is a leaf of the tree; each block one time it ran, coloured by how it ended (hover for the "
        "reason). Below, the strategies from choice to verdict, and the injected faults while in effect."
    )
    return Figure("timeline", "Timeline", legend(words) + drawn, caption)


def _row(time: Scale, y: float, name: str, path: str, spans: list[Span]) -> str:
    label = svg.element("g", svg.title(path), svg.text(_LEFT - 8, y + 14, name[-30:], class_="lane end"))
    base = svg.line(time.start, y + _ROW / 2, time.end, y + _ROW / 2, class_="grid")
    return label + base + "".join(_block(time, y, name, span) for span in spans)


def _block(time: Scale, y: float, name: str, span: Span) -> str:
    left, right = time.clamp(span.start_s), time.clamp(span.end_s)
    words = f"{name}, {duration(span.start_s)} to {duration(span.end_s)}: {span.words}"
    return svg.element(
        "rect",
        svg.title(words),
        x=left,
        y=y + 4,
        width=max(right - left, 1.6),
        height=_ROW - 8,
        rx=1.5,
        fill=_COLOURS.get(span.kind, palette.MUTED),
        fill_opacity=0.88,
    )


def hypotheses(run: Run) -> Figure | None:
    """Stacked areas of the hypotheses' weights; None where none were weighed."""
    events = run.history.all(HypothesesEvent)
    names = _likely([at.event for at in events])
    if not names:
        return None
    times = np.array([at.time_s for at in events])
    weights = np.array([[at.event.weights.get(name, 0.0) for name in names] for at in events]).T
    time = Scale(0.0, run.end_s, _LEFT, _WIDTH - 8)
    chart = Chart(time, Scale(0.0, 1.0, 180.0, 24.0))
    upper = np.cumsum(weights, axis=0)
    areas = [
        _area(chart, times, upper[k] - weights[k], upper[k], colour, name)
        for k, (name, colour) in enumerate(zip(names, palette.SERIES, strict=False))
    ]
    ahead = _margins_ahead(time, events)
    body = [*areas, time_axis(time, 24, 180), chart.frame("weight", [0.0, 0.5, 1.0], 1), *ahead]
    drawn = svg.drawing(_WIDTH, 204, body, aria_label="Weights of the hypotheses", **timed(time, 24, 180))
    entries = [("solid", c, n.replace("_", " ")) for n, c in zip(names, palette.SERIES, strict=False)]
    entries += [("solid", palette.BAD, "off-track margin ahead")] if ahead else []
    caption = (
        "What the in-situ classification held likely. The weights sum to 1; a hypothesis that takes over "
        "the pale nominal area is the diagnosis from which a strategy is chosen. Those never above 0.05 are "
        "left out. Dots: a choice among strategies (hover for when the off-track margin would be crossed)."
    )
    return Figure("hypotheses", "Hypotheses", legend(entries) + drawn, caption)


def _margins_ahead(time: Scale, events: list[At[HypothesesEvent]]) -> list[str]:
    """A dot where it was extrapolated that, going on like this, the off-track margin would be crossed."""
    return [
        svg.element(
            "circle",
            svg.title(f"at {duration(at.time_s)}: off-track margin in {duration(left_s)}"),
            cx=time(at.time_s),
            cy=18,
            r=3,
            fill=palette.BAD,
        )
        for at in events
        if (left_s := at.event.time_to_margin_s) is not None
    ]


def _likely(events: list[HypothesesEvent]) -> list[str]:
    """The nominal hypothesis first, then the others that were ever likely, likeliest first."""
    best: dict[str, float] = {}
    for event in events:
        for name, weight in event.weights.items():
            best[name] = max(weight, best.get(name, 0.0))
    ranked = sorted((n for n in best if best[n] > 0.05), key=lambda n: (n != "nominal", -best[n]))
    return ranked[: len(palette.SERIES)]


def _area(chart: Chart, times: Array, low: Array, high: Array, colour: str, name: str) -> str:
    t_high, v_high = thinned(times, high)
    t_low, v_low = thinned(times, low)
    outline = [(chart.time(t), chart.value.clamp(v)) for t, v in zip(t_high, v_high, strict=True)]
    outline += [(chart.time(t), chart.value.clamp(v)) for t, v in zip(t_low[::-1], v_low[::-1], strict=True)]
    return svg.element("polygon", svg.title(name), points=svg.points(outline), fill=colour, fill_opacity=0.92)
