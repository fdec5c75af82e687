"""Lanes over mission time as HTML: names readable at any width, blocks that stretch, groups that fold.

Without scripts everything is there and groups unfold; the search field shows once a script runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

from executive.report import palette, svg
from executive.report.axes import Scale, time_ticks, timed
from executive.report.figure import counted, duration
from executive.report.spans import Span

_WIDTH, _HEIGHT = 1000.0, 16.0
_COLOURS = {**palette.STATUS, "strategy": palette.STRATEGY, "fault": palette.FAULT}
_SEARCH = (
    "<label class='search' hidden>Find a leaf "
    "<input type='search' id='find-lane' placeholder='localise, failure, …'/></label>"
)


@dataclass(frozen=True)
class Lane:
    """One row: its name, the whole path for hovering and searching, and its stretches."""

    name: str
    path: str
    spans: tuple[Span, ...]


@dataclass(frozen=True)
class Group:
    """Rows under one title; one that can be folded starts `open` or closed."""

    title: str
    lanes: tuple[Lane, ...]
    fold: bool = True
    open: bool = True


def drawn(groups: list[Group], end_s: float) -> str:
    """All groups over one time axis."""
    time = Scale(0.0, end_s, 0.0, _WIDTH)
    return f"<div class='lanes'>{_SEARCH}{''.join(_group(g, time) for g in groups)}{_axis(time)}</div>"


def _group(group: Group, time: Scale) -> str:
    rows = "".join(_lane(lane, time) for lane in group.lanes)
    if group.fold and len(group.lanes) == 1:
        return f"<div class='group one'>{rows}</div>"
    title = f"<b>{escape(group.title)}</b>"
    if not group.fold:
        return f"<div class='group'><div class='lane'><span>{title}</span></div>{rows}</div>"
    every = tuple(span for lane in group.lanes for span in lane.spans)
    failed = sum(span.kind == "failure" for span in every)
    said = counted(len(group.lanes), "leaf", "leaves") + (f", {counted(failed, 'failure')}" if failed else "")
    name = f"<span>{title} <i>{said}</i></span>"
    opened = " open" if group.open else ""
    summary = f"<summary class='lane'>{name}{_strip(group.title, every, time)}</summary>"
    return f"<details class='group'{opened}>{summary}{rows}</details>"


def _lane(lane: Lane, time: Scale) -> str:
    kinds = " ".join(dict.fromkeys(span.kind for span in lane.spans))
    name = f"<span title='{escape(lane.path, quote=True)}'>{escape(lane.name)}</span>"
    find = escape(f"{lane.path} {kinds}".lower(), quote=True)
    return f"<div class='lane' data-find='{find}'>{name}{_strip(lane.name, lane.spans, time)}</div>"


def _strip(name: str, spans: tuple[Span, ...], time: Scale) -> str:
    """The blocks of a row, failures on top, stretched to whatever width there is."""
    base = svg.line(0, _HEIGHT / 2, _WIDTH, _HEIGHT / 2, class_="grid", vector_effect="non-scaling-stroke")
    ranked = sorted(spans, key=lambda span: span.kind == "failure")
    return svg.drawing(
        _WIDTH,
        _HEIGHT,
        [base, *(_block(time, name, span) for span in ranked)],
        preserveAspectRatio="none",
        aria_label=f"when {name} ran",
        **timed(time, 0.0, _HEIGHT),
    )


def _block(time: Scale, name: str, span: Span) -> str:
    left, right = time.clamp(span.start_s), time.clamp(span.end_s)
    words = f"{name}, {duration(span.start_s)} to {duration(span.end_s)}: {span.words}"
    return svg.element(
        "rect",
        svg.title(words),
        x=min(left, _WIDTH - 2.0),
        y=2.0,
        width=max(right - left, 2.0),
        height=_HEIGHT - 4.0,
        fill=_COLOURS.get(span.kind, palette.MUTED),
    )


def _axis(time: Scale) -> str:
    marks, name = time_ticks(time.high)
    seconds, unit = {"h": 3600.0, "min": 60.0, "s": 1.0}[name], f"\u00a0{name}"
    labels = "".join(
        f"<i style='left:{100 * t / time.high:.2f}%'>{t / seconds:g}{unit * (t == marks[-1])}</i>"
        for t in marks
    )
    return f"<div class='lane axis'><span></span><div>{labels}</div></div>"
