"""How long after a fault took effect it was noticed, named, and recovered from."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from executive.record import FaultStages
from executive.report import svg
from executive.report.axes import Scale, legend
from executive.report.figure import Figure, counted, duration
from proving.campaign_report.gather import RecordedCampaign

_WIDTH, _LEFT, _TOP, _ROW, _PANEL, _GAP = 1100.0, 150.0, 34.0, 26.0, 255.0, 62.0
_TICKS_S = {10.0: "10 s", 60.0: "1 min", 600.0: "10 min", 3600.0: "1 h", 14400.0: "4 h"}
_LEAST_S, _MOST_S = 5.0, 14400.0


class Stage(NamedTuple):
    """One of the things that should follow a fault, and the time at which it did."""

    title: str
    time_s: Callable[[FaultStages], float | None]
    colour: str


STAGES = (
    Stage("detected", lambda row: row.t_detected_s, "var(--s0)"),
    Stage("isolated", lambda row: row.t_isolated_s, "var(--s2)"),
    Stage("recovered", lambda row: row.t_recovered_s, "var(--good)"),
)


def latencies(campaign: RecordedCampaign) -> Figure | None:
    """Three strips per kind of fault; None where no fault fired."""
    rows = [row for case in campaign.counted for row in case.faults if row.fired]
    if not rows:
        return None
    kinds = sorted({row.kind for row in rows})
    bottom = _TOP + len(kinds) * _ROW
    body = [
        svg.text(0, _TOP + n * _ROW + 17, kind.replace("_", " "), class_="lane")
        for n, kind in enumerate(kinds)
    ]
    for number, stage in enumerate(STAGES):
        scale = _scale(_LEFT + number * (_PANEL + _GAP))
        body.append(_frame(scale, stage.title, bottom))
        for n, kind in enumerate(kinds):
            mine = [row for row in rows if row.kind == kind]
            body.append(_strip(mine, stage, scale, _TOP + n * _ROW + _ROW / 2))
    drawn = svg.drawing(_WIDTH, bottom + 26, body, aria_label="Latencies by fault")
    words = [("dot", "var(--s0)", "one fault"), ("solid", "var(--muted)", "middle half, with the median")]
    caption = (
        "Mission time from taking effect: until the nominal hypothesis no longer led (detected), until the "
        "expected one led (isolated), until the nominal one led again (recovered). The scale is logarithmic; "
        "what took less than 5 s stands at its left end. Under “never”, the faults for which it did not "
        "happen: some never need to be noticed, as one LED of four."
    )
    return Figure("latencies", "Latencies", legend(words) + drawn, caption)


def _scale(start: float) -> Scale:
    return Scale(math.log(_LEAST_S), math.log(_MOST_S), start, start + _PANEL)


def _frame(scale: Scale, title: str, bottom: float) -> str:
    body = [
        svg.line(scale(math.log(t)), _TOP - 6, scale(math.log(t)), bottom, class_="grid")
        + svg.text(scale(math.log(t)), bottom + 16, words, class_="tick mid")
        for t, words in _TICKS_S.items()
    ]
    never = svg.text(scale.end + 36, 14, "never", class_="axis end")
    return svg.text(scale.start, 14, title, class_="axis") + never + "".join(body)


def _strip(rows: list[FaultStages], stage: Stage, scale: Scale, y: float) -> str:
    times = [row.latency_s(stage.time_s(row)) for row in rows]
    known = np.array([t for t in times if t is not None])
    never = len(times) - len(known)
    body = [_box(known, scale, y)] if len(known) >= 3 else []
    offsets = 4.5 * np.sin(2.4 * np.arange(len(known)))  # spread evenly, the same in every report
    for t, dy in zip(sorted(known), offsets, strict=True):
        x = scale.clamp(math.log(max(float(t), _LEAST_S)))
        dot = svg.element("circle", cx=x, cy=float(y + dy), r=2.5, fill=stage.colour, fill_opacity=0.65)
        body.append(dot)
    count = svg.text(scale.end + 36, y + 4, str(never) if never else "–", class_="lane end")
    said = svg.title(_words(rows[0].kind, stage.title, known, never))
    return svg.element("g", said, *body, count)


def _box(known: np.ndarray[tuple[int], np.dtype[np.float64]], scale: Scale, y: float) -> str:
    low, middle, high = (
        scale.clamp(math.log(max(float(t), _LEAST_S))) for t in np.percentile(known, [25, 50, 75])
    )
    return svg.element(
        "rect", x=low, y=y - 8, width=max(high - low, 1.0), height=16.0, class_="box"
    ) + svg.line(middle, y - 9, middle, y + 9, class_="median")


def _words(kind: str, title: str, known: np.ndarray[tuple[int], np.dtype[np.float64]], never: int) -> str:
    if not len(known):
        return f"{kind}: never {title}, in {counted(never, 'case')}"
    middle = duration(float(np.median(known)))
    return f"{kind}: {title} after {middle} in the median of {len(known)}, never in {never}"
