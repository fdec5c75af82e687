"""Charts over mission time: scales, ticks, a frame, lines and bands. All share one time axis."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from executive.core.types import Array
from executive.report import svg

_MOST_POINTS = 900


@dataclass(frozen=True)
class Scale:
    """A linear map from values [low, high] to pixels [start, end]."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        return self.start + (value - self.low) / ((self.high - self.low) or 1.0) * (self.end - self.start)

    def clamp(self, value: float) -> float:
        """The pixel of a value, held inside the scale."""
        return self(min(max(value, self.low), self.high))


def ticks(low: float, high: float, about: int = 5) -> list[float]:
    """Round values inside [low, high], some `about` of them."""
    span = max(high - low, 1e-12)
    rough = 10 ** math.floor(math.log10(span / about))
    step = next(m * rough for m in (1, 2, 5, 10) if span / (m * rough) <= about + 0.5)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def time_ticks(end_s: float) -> tuple[list[float], str]:
    """Ticks over [0, end_s] at round minutes or hours [s], and the unit of their labels."""
    unit, name = (3600.0, "h") if end_s > 4 * 3600 else (60.0, "min") if end_s > 240 else (1.0, "s")
    return [t * unit for t in ticks(0.0, end_s / unit, 9)], name


def thinned(time_s: Array, values: Array) -> tuple[Array, Array]:
    """At most some 900 points that keep the lowest and highest of every stretch."""
    if len(time_s) <= _MOST_POINTS:
        return time_s, values
    kept: set[int] = {0, len(time_s) - 1}
    for stretch in np.array_split(np.arange(len(time_s)), _MOST_POINTS // 2):
        finite = stretch[np.isfinite(values[stretch])]
        if finite.size:
            kept |= {int(finite[values[finite].argmin()]), int(finite[values[finite].argmax()])}
        else:
            kept.add(int(stretch[0]))
    index = np.array(sorted(kept))
    return time_s[index], values[index]


@dataclass(frozen=True)
class Chart:
    """A rectangle of a drawing with a time axis and a value axis."""

    time: Scale
    value: Scale

    def line(self, time_s: Array, values: Array, **attributes: object) -> str:
        """A line, broken where a value is NaN."""
        time_s, values = thinned(np.asarray(time_s), np.asarray(values, dtype=np.float64))
        pieces, piece = [], list[tuple[float, float]]()
        for t, v in zip(time_s, values, strict=True):
            if math.isfinite(v):
                piece.append((self.time(t), self.value.clamp(v)))
            elif piece:
                pieces.append(piece)
                piece = []
        pieces.append(piece)
        return "".join(svg.polyline(p, stroke_linejoin="round", **attributes) for p in pieces if p)

    def band(self, from_s: float, to_s: float, low: float, high: float, **attributes: object) -> str:
        """A rectangle in time and value."""
        top, bottom = self.value.clamp(high), self.value.clamp(low)
        left, right = self.time.clamp(from_s), self.time.clamp(to_s)
        return svg.element(
            "rect", x=left, y=top, width=max(right - left, 0.0), height=max(bottom - top, 0.0), **attributes
        )

    def frame(self, label: str, at: Sequence[float] | None = None, decimals: int | None = None) -> str:
        """Grid lines and labels of the value axis, and the axis' name over it."""
        marks = ticks(self.value.low, self.value.high) if at is None else at
        digits = _digits(marks) if decimals is None else decimals
        body = [
            svg.line(self.time.start, self.value(v), self.time.end, self.value(v), class_="grid")
            + svg.text(self.time.start - 6, self.value(v) + 3.5, f"{v:.{digits}f}", class_="tick end")
            for v in marks
        ]
        name = svg.text(self.time.start, self.value.end - 8, label, class_="axis")
        return "".join(body) + name


def _digits(marks: Sequence[float]) -> int:
    """Decimals that tell neighbouring ticks apart."""
    step = abs(marks[1] - marks[0]) if len(marks) > 1 else 1.0
    return max(0, -math.floor(math.log10(step) + 1e-9)) if step > 0 else 0


def time_axis(time: Scale, top: float, bottom: float, labelled: bool = True) -> str:
    """Vertical grid lines at round times from `top` to `bottom` [px], labelled below."""
    marks, unit = time_ticks(time.high)
    seconds = {"h": 3600.0, "min": 60.0, "s": 1.0}[unit]
    body = []
    for t in marks:
        body.append(svg.line(time(t), top, time(t), bottom, class_="grid"))
        if labelled:
            last = " " + unit if t == marks[-1] else ""
            body.append(svg.text(time(t), bottom + 15, f"{t / seconds:g}{last}", class_="tick mid"))
    return "".join(body)


def timed(time: Scale, top: float, bottom: float) -> dict[str, object]:
    """Attributes that let the page's time cursor find this chart."""
    return {
        "class_": "timed",
        "data_t1": time.high,
        "data_x0": time.start,
        "data_x1": time.end,
        "data_y0": top,
        "data_y1": bottom,
    }


def legend(entries: Iterable[tuple[str, str, str]]) -> str:
    """An HTML legend of (kind, colour, words); kind is line, dash, dot, ring, area, mark or warn."""
    return (
        "<ul class='legend'>"
        + "".join(f"<li>{_swatch(kind, colour)}{words}</li>" for kind, colour, words in entries)
        + "</ul>"
    )


def _swatch(kind: str, colour: str) -> str:
    shapes = {
        "line": svg.line(0, 6, 22, 6, stroke=colour, stroke_width=2),
        "dash": svg.line(0, 6, 22, 6, stroke=colour, stroke_width=1.6, stroke_dasharray="5 3"),
        "dot": svg.element("circle", cx=11, cy=6, r=3.4, fill=colour),
        "ring": svg.element("circle", cx=11, cy=6, r=4.5, fill="none", stroke=colour, stroke_width=1.6),
        "area": svg.element("rect", x=1, y=1, width=20, height=10, rx=1.5, fill=colour, fill_opacity=0.45),
        "solid": svg.element("rect", x=1, y=1, width=20, height=10, rx=1.5, fill=colour),
        "warn": svg.polygon([(5, 1), (17, 1), (11, 12)], fill=colour),
        "mark": svg.polygon([(11, 0), (17, 6), (11, 12), (5, 6)], fill=colour),
    }
    return svg.element("svg", shapes[kind], width=22, height=12, viewBox="0 0 22 12", aria_hidden="true")
