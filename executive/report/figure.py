"""A figure of the report: a drawing and the caption that explains it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """`body` is HTML; `caption` a paragraph of plain text."""

    key: str
    title: str
    body: str
    caption: str


def duration(seconds: float) -> str:
    """Mission time for people: 45 s, 12 min 05 s, 3 h 07 min; a dash where it is no finite number."""
    if not math.isfinite(seconds):
        return "–"
    whole = round(seconds)
    if whole < 60:
        parts = [f"{whole} s"]
    elif whole < 3600:
        parts = [f"{whole // 60} min", f"{whole % 60:02d} s"]
    else:
        parts = [f"{whole // 3600} h", f"{whole % 3600 // 60:02d} min"]
    return " ".join(parts).replace(" ", "\u00a0")  # never broken over two lines


def counted(count: int, noun: str, several: str | None = None) -> str:
    """A number of things for people: 1 case, 2 cases; `several` where that is not the noun with an s."""
    return f"{count} {noun if count == 1 else several or noun + 's'}"


def millimetres(metres: float | None, digits: int = 1) -> str:
    """A length in mm, a dash where there is none."""
    return "–" if metres is None else f"{metres * 1000:.{digits}f} mm"
