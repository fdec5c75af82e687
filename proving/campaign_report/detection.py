"""Which fault was taken for what: the detection matrix."""

from __future__ import annotations

from collections import Counter

from executive.record import FaultStages
from executive.report import svg
from executive.report.axes import legend
from executive.report.figure import Figure
from proving.campaign_report.gather import RecordedCampaign

_LEFT, _TOP, _CELL_W, _CELL_H, _WIDTH = 216.0, 104.0, 104.0, 30.0, 1100.0
UNDETECTED = "not detected"


def matrix(rows: list[FaultStages]) -> dict[str, Counter[str]]:
    """Kind of fault → how often each diagnosis was concluded, for the faults that fired."""
    counts: dict[str, Counter[str]] = {}
    for row in rows:
        if row.fired:
            counts.setdefault(row.kind, Counter())[row.concluded or UNDETECTED] += 1
    return dict(sorted(counts.items()))


def detection(campaign: RecordedCampaign) -> Figure | None:
    """The matrix as a heat map; None where no fault fired."""
    rows = [row for case in campaign.counted for row in case.faults]
    counts = matrix(rows)
    if not counts:
        return None
    expected = {row.kind: row.expected for row in rows if row.expected}
    columns = _columns(counts, expected)
    width = min(_CELL_W, (_WIDTH - _LEFT - 60) / len(columns))
    body = [_heads(columns, width)]
    for number, (kind, found) in enumerate(counts.items()):
        body.append(_line(kind, found, columns, width, _TOP + number * _CELL_H, expected.get(kind)))
    drawn = svg.drawing(
        _WIDTH, _TOP + len(counts) * _CELL_H + 6, body, aria_label="Detection matrix, faults by diagnosis"
    )
    words = [("area", "var(--s0)", "share of the row"), ("ring", "var(--ink)", "the expected diagnosis")]
    caption = (
        "Each row is a kind of fault, counted once for every time it took effect; each column what "
        "the classification concluded. The stronger its colour, the larger a cell's share of the row; the "
        "outlined cell is the diagnosis that the fault should lead to. In a case with two faults the "
        "conclusion may stem from the other one."
    )
    return Figure("detection", "Detection: fault against diagnosis", legend(words) + drawn, caption)


def _columns(counts: dict[str, Counter[str]], expected: dict[str, str]) -> list[str]:
    """The expected diagnoses in the order of their faults, then the others, `not detected` last."""
    wanted = [expected[kind] for kind in counts if kind in expected]
    others = sorted({name for found in counts.values() for name in found} - {*wanted, UNDETECTED})
    return [*dict.fromkeys(wanted), *others, UNDETECTED]


def _heads(columns: list[str], width: float) -> str:
    return "".join(
        svg.element(
            "text",
            name.replace("_", " "),
            x=0,
            y=0,
            transform=f"translate({_LEFT + (n + 0.5) * width:.1f} {_TOP - 8}) rotate(-32)",
            class_="lane",
        )
        for n, name in enumerate(columns)
    )


def _line(
    kind: str, found: Counter[str], columns: list[str], width: float, y: float, expected: str | None
) -> str:
    total = found.total()
    body = [
        svg.text(0, y + 20, kind.replace("_", " "), class_="lane"),
        svg.text(_LEFT - 14, y + 20, str(total), class_="tick end"),
    ]
    for n, name in enumerate(columns):
        body.append(_cell(_LEFT + n * width, y, width, found[name], total, f"{kind} taken for {name}"))
    if expected in columns:
        x = _LEFT + columns.index(expected) * width
        body.append(
            svg.element("rect", x=x + 1.5, y=y + 1.5, width=width - 4, height=_CELL_H - 4, class_="wanted")
        )
    return "".join(body)


def _cell(x: float, y: float, width: float, count: int, total: int, words: str) -> str:
    part = count / total
    box = svg.element(
        "rect",
        x=x,
        y=y,
        width=width - 1,
        height=_CELL_H - 1,
        fill="var(--s0)" if count else "var(--line)",
        fill_opacity=round(0.12 + 0.83 * part, 3) if count else 0.35,
    )
    number = svg.text(x + width / 2, y + 20, str(count), class_="inside" if part > 0.45 else "lane mid")
    return svg.element("g", svg.title(f"{words}: {count} of {total}"), box, number if count else "")
