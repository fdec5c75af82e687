"""Who did what when: leaves, strategies, faults, and the weights of the hypotheses, over mission time."""

from __future__ import annotations

import numpy as np

from executive.core.types import Array
from executive.record.events import HypothesesEvent
from executive.record.history import At
from executive.report import palette, svg
from executive.report.axes import Chart, Scale, legend, thinned, time_axis, timed
from executive.report.figure import Figure, duration
from executive.report.gather import RecordedRun
from executive.report.lanes import Group, Lane, drawn
from executive.report.spans import (
    Span,
    fault_spans,
    leaf_spans,
    short_names,
    strategy_spans,
    telling_parts,
)

_WIDTH, _LEFT = 1100.0, 200.0
_UNFOLDED = 24
"""The most leaves that are shown without folding."""


def timeline(run: RecordedRun) -> Figure | None:
    """Lanes of leaves in foldable groups, of strategies and of faults; None where nothing was recorded."""
    groups = [
        *_leaves(run),
        Group("strategies", _lanes(strategy_spans(run)), fold=False),
        Group("faults", _lanes(fault_spans(run)), fold=False),
    ]
    groups = [group for group in groups if group.lanes]
    if not groups:
        return None
    words = [
        ("solid", palette.GOOD, "ended in success"),
        ("solid", palette.BAD, "ended in failure"),
        ("solid", palette.STATUS["invalid"], "interrupted"),
        ("solid", palette.BUSY, "still under way"),
    ]
    caption = (
        "Every leaf of the tree that was entered, in groups by the tree it stands in: each block is one time "
        "it ran, coloured by how it ended (hover for the reason); the line of a folded group shows all "
        "of its leaves. Below, the strategies from choice to verdict, and the faults while in effect."
    )
    return Figure("timeline", "Timeline", legend(words) + drawn(groups, run.end_s), caption)


def _leaves(run: RecordedRun) -> list[Group]:
    """The leaves, grouped by the tree or named node that they stand in; open where they fill no page."""
    spans = leaf_spans(run)
    names = short_names(list(spans))
    grouped: dict[str, list[Lane]] = {}
    for path, of_leaf in spans.items():
        group, _, name = names[path].rpartition("/")
        home = group or _home(path)
        grouped.setdefault(home, []).append(Lane(name or path, path, tuple(of_leaf)))
    unfolded = len(spans) <= _UNFOLDED
    return [Group(home, tuple(lanes), open=unfolded) for home, lanes in grouped.items()]


def _home(path: str) -> str:
    """The nearest telling node above a leaf whose own name says enough."""
    telling = telling_parts(path.split("/"))[:-1]
    return telling[-1] if telling else path.split("/")[0]


def _lanes(spans: dict[str, list[Span]]) -> tuple[Lane, ...]:
    return tuple(Lane(name, name, tuple(of_one)) for name, of_one in spans.items())


def hypotheses(run: RecordedRun) -> Figure | None:
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
