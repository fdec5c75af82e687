"""What was varied from case to case, and how success went with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from executive.core.units import UnitError, split
from executive.report import svg
from executive.report.axes import Scale, legend, ticks
from executive.report.figure import Figure
from proving.campaign_report.case import RecordedCase
from proving.campaign_report.gather import RecordedCampaign
from proving.campaign_report.statistics import share

_PARTS = ("world", "rig", "mission")
_WIDTH, _LEFT, _RIGHT = 540.0, 10.0, 530.0
_MOST, _BINS, _BOTTOM, _TOP = 16, 5, 128.0, 30.0


class Varied(NamedTuple):
    """A numeric parameter that differs among cases: dotted key, unit, and each case's value."""

    key: str
    unit: str
    values: tuple[tuple[RecordedCase, float], ...]


def varied(campaign: RecordedCampaign) -> list[Varied]:
    """The numeric parameters of world, rig and mission that take more than one value."""
    found: dict[str, list[tuple[RecordedCase, str]]] = {}
    for case in campaign.counted:
        for part in _PARTS:
            for key, text in _leaves(case.scenario.get(part), part):
                found.setdefault(key, []).append((case, text))
    several = {key: pairs for key, pairs in found.items() if len({text for _, text in pairs}) > 1}
    made = [_varied(key, pairs) for key, pairs in sorted(several.items())]
    return [one for one in made if one is not None]


def parameters(campaign: RecordedCampaign) -> Figure | None:
    """A panel per parameter: success over its range; None where nothing numeric was varied."""
    found = varied(campaign)
    if not found:
        return None
    panels = "".join(f"<div class='panel'>{_panel(one)}</div>" for one in found[:_MOST])
    words = [
        ("dot", "var(--good)", "a case that passed"),
        ("dot", "var(--bad)", "one that did not"),
        ("line", "var(--s0)", "share that passed, with its interval"),
    ]
    more = f" {len(found) - _MOST} further parameters are left out." if len(found) > _MOST else ""
    caption = (
        "Each tick is a case at the value it drew; the points are the share that passed in each fifth of the "
        f"cases, with 95 % Wilson intervals, or at each value where there are few.{more}"
    )
    body = legend(words) + f"<div class='panels'>{panels}</div>"
    return Figure("parameters", "Parameters varied", body, caption)


def _leaves(data: object, key: str) -> Iterator[tuple[str, str]]:
    if isinstance(data, Mapping):
        for name, inner in data.items():
            yield from _leaves(inner, f"{key}.{name}")
    elif isinstance(data, list):
        for index, inner in enumerate(data):
            yield from _leaves(inner, f"{key}.{index}")
    elif isinstance(data, str | int | float) and not isinstance(data, bool):
        yield key, str(data)


def _varied(key: str, pairs: list[tuple[RecordedCase, str]]) -> Varied | None:
    try:
        read = [(case, *split(text)) for case, text in pairs]
    except UnitError:
        return None
    unit = read[0][2]
    factor, shown = (180 / np.pi, "deg") if unit == "rad" else (1.0, unit)
    return Varied(key, shown, tuple((case, value * factor) for case, value, _ in read))


def _panel(one: Varied) -> str:
    values = np.array([value for _, value in one.values])
    low, high = float(values.min()), float(values.max())
    pad = 0.04 * (high - low)
    across, up = Scale(low - pad, high + pad, _LEFT + 34, _RIGHT), Scale(0.0, 1.0, _BOTTOM, _TOP)
    body = [_axes(across, up, low, high)]
    for case, value in one.values:
        colour, foot = ("var(--good)", _BOTTOM + 4) if case.passed else ("var(--bad)", _BOTTOM + 12)
        body.append(
            svg.line(across(value), foot, across(value), foot + 7, stroke=colour, stroke_opacity=0.65)
        )
    for part in _bins(one):
        found = share(sum(case.passed for case, _ in part), len(part))
        x = across(float(np.mean([value for _, value in part])))
        body.append(
            svg.line(x, up(found.low), x, up(found.high), stroke="var(--s0)", stroke_width=2)
            + svg.element("circle", cx=x, cy=up(found.value), r=4.0, fill="var(--s0)", class_="halo")
        )
    title = f"{one.key}{f' [{one.unit}]' if one.unit else ''}"
    body.append(svg.text(_LEFT, 14, title, class_="axis"))
    return svg.drawing(_WIDTH, _BOTTOM + 40, body, aria_label=title)


def _axes(across: Scale, up: Scale, low: float, high: float) -> str:
    body = [
        svg.line(across.start, up(v), across.end, up(v), class_="grid")
        + svg.text(across.start - 6, up(v) + 3.5, f"{100 * v:.0f} %", class_="tick end")
        for v in (0.0, 0.5, 1.0)
    ]
    body += [svg.text(across(v), _BOTTOM + 34, f"{v:g}", class_="tick mid") for v in ticks(low, high, 6)]
    return "".join(body)


def _bins(one: Varied) -> list[list[tuple[RecordedCase, float]]]:
    """Cases by value where there are few values, else in fifths of equal number."""
    ordered = sorted(one.values, key=lambda pair: pair[1])
    distinct = sorted({value for _, value in ordered})
    if len(distinct) <= _BINS:
        return [[pair for pair in ordered if pair[1] == value] for value in distinct]
    pieces = np.array_split(np.arange(len(ordered)), _BINS)
    return [[ordered[i] for i in piece] for piece in pieces if len(piece)]
