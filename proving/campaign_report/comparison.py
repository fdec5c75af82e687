"""Two settings on common random numbers: the same seeds, faults and ground under both."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape

from executive.core.chance import generator
from executive.report import svg
from executive.report.axes import Scale, legend
from executive.report.figure import Figure
from proving.campaign_report.case import RecordedCase
from proving.campaign_report.gather import RecordedCampaign
from proving.campaign_report.groups import SERIES
from proving.campaign_report.lengths import length
from proving.campaign_report.statistics import Estimate, Pairs, median

_TICKS_M = {0.001: "1 mm", 0.01: "10 mm", 0.1: "0.1 m", 1.0: "1 m", 10.0: "10 m"}
_SIDE, _LEFT, _TOP = 400.0, 64.0, 24.0


@dataclass(frozen=True)
class CampaignComparison:
    """`first` is what `second` is held against; `couples` are the cases that met the same conditions."""

    first: str
    second: str
    key: str
    couples: tuple[tuple[RecordedCase, RecordedCase], ...]
    error_m: Estimate
    """Median over the pairs of the second's error at the end less the first's."""

    @property
    def pairs(self) -> Pairs:
        return Pairs.of([(a.passed, b.passed) for a, b in self.couples])


def comparisons(campaign: RecordedCampaign) -> list[CampaignComparison]:
    """Every further setting against the first."""
    first, *others = campaign.settings
    return [_comparison(campaign, first, other, f"compare-{n}") for n, other in enumerate(others, 1)]


def _comparison(campaign: RecordedCampaign, first: str, second: str, key: str) -> CampaignComparison:
    by_seed = {case.seed: case for case in campaign.of_setting(second)}
    couples = tuple((a, by_seed[a.seed]) for a in campaign.of_setting(first) if a.seed in by_seed)
    errors = [b - a for a, b in _errors_m(couples)]
    rng = generator(campaign.seed, f"report {first} {second}")
    return CampaignComparison(first, second, key, couples, median(errors, rng))


def _errors_m(couples: tuple[tuple[RecordedCase, RecordedCase], ...]) -> list[tuple[float, float]]:
    known = [(a.result.truth.final_error_m, b.result.truth.final_error_m) for a, b in couples]
    return [(a, b) for a, b in known if a is not None and b is not None]


def compared(found: CampaignComparison) -> Figure | None:
    """The fourfold table, the differences, and each pair's errors; None where there is no pair."""
    if not found.couples:
        return None
    body = f"<div class='paired'>{_scatter(found)}<div>{_figures(found)}{_fourfold(found)}</div></div>"
    words = [
        ("dot", "var(--muted)", "both passed, or neither"),
        ("dot", SERIES[0], f"only {escape(found.first)} passed"),
        ("dot", SERIES[1], f"only {escape(found.second)} passed"),
    ]
    caption = (
        "Each dot is a pair of cases with the same seed: the same ground, faults and noise, so that what "
        "differs is the setting. Below the diagonal the second setting ended nearer to the goal. Only pairs "
        "that disagree speak about success: McNemar's exact test asks how likely so lopsided a split is by "
        "chance. Intervals are at 95 %: Newcombe's for the difference of paired shares, bootstrap for the "
        "median."
    )
    title = f"{found.second} against {found.first}"
    return Figure(found.key, title, legend(words) + body, caption)


def _figures(found: CampaignComparison) -> str:
    difference, pairs = found.pairs.difference(), found.pairs
    rows = [
        ("pairs", str(pairs.total), ""),
        (
            "difference of success",
            f"{100 * difference.value:+.1f} points",
            f"{100 * difference.low:+.1f} to {100 * difference.high:+.1f}",
        ),
        (
            "McNemar, exact",
            _p_text(pairs.p_value()),
            f"{pairs.only_first + pairs.only_second} pairs disagree",
        ),
        ("final error, median difference", _signed(found.error_m.value), _interval(found.error_m)),
    ]
    return (
        "<div class='tiles four'>"
        + "".join(
            f"<div class='tile'><span class='label'>{label}</span><span class='value'>{value}</span>"
            f"<span class='remark'>{remark}</span></div>"
            for label, value, remark in rows
        )
        + "</div>"
    )


def _p_text(p: float) -> str:
    return f"p = {p:.3f}" if p >= 0.001 else "p < 0.001"


def _signed(value_m: float) -> str:
    sign = "" if abs(value_m) < 5e-5 else "+" if value_m > 0 else "−"
    return "–" if math.isnan(value_m) else f"{sign}{length(abs(value_m))}"


def _interval(found: Estimate) -> str:
    return f"{_signed(found.low)} to {_signed(found.high)}"


def _fourfold(found: CampaignComparison) -> str:
    pairs, first, second = found.pairs, escape(found.first), escape(found.second)
    return (
        f"<table class='fourfold'><thead><tr><th></th><th>{second} passed</th><th>{second} did not</th></tr>"
        f"</thead><tbody><tr><th>{first} passed</th><td>{pairs.both}</td><td>{pairs.only_first}</td></tr>"
        f"<tr><th>{first} did not</th><td>{pairs.only_second}</td><td>{pairs.neither}</td></tr>"
        "</tbody></table>"
    )


def _scatter(found: CampaignComparison) -> str:
    known = _errors_m(found.couples)
    high = max([0.1, *(max(pair) for pair in known)]) * 1.3
    low = min([0.005, *(max(min(pair), 2e-4) for pair in known)]) / 1.3
    x = Scale(math.log(low), math.log(high), _LEFT, _LEFT + _SIDE)
    y = Scale(math.log(low), math.log(high), _TOP + _SIDE, _TOP)
    body = [_frame(x, y), svg.line(x.start, y.start, x.end, y.end, class_="mean")]
    for a, b in found.couples:
        errors = a.result.truth.final_error_m, b.result.truth.final_error_m
        if errors[0] is None or errors[1] is None:
            continue
        colour = "var(--muted)" if a.passed == b.passed else SERIES[0] if a.passed else SERIES[1]
        said = f"cases {a.index} and {b.index}: {length(errors[0])}, {length(errors[1])}"
        place = {"cx": x.clamp(_log(errors[0])), "cy": y.clamp(_log(errors[1]))}
        dot = svg.element("circle", **place, r=3.6, fill=colour, fill_opacity=0.75)
        body.append(svg.element("g", svg.title(said), dot))
    body.append(svg.text(x.end, y.start + 34, f"true error at the end, {found.first}", class_="axis end"))
    body.append(svg.text(x.start, y.end - 10, f"true error at the end, {found.second}", class_="axis"))
    label = f"Errors of {found.first} and {found.second}"
    return svg.drawing(_LEFT + _SIDE + 12, _TOP + _SIDE + 40, body, aria_label=label)


def _log(error_m: float) -> float:
    return math.log(max(error_m, 1e-9))


def _frame(x: Scale, y: Scale) -> str:
    body = []
    for value, words in _TICKS_M.items():
        if x.low <= math.log(value) <= x.high:
            across, up = x(math.log(value)), y(math.log(value))
            body.append(svg.line(across, y.start, across, y.end, class_="grid"))
            body.append(svg.line(x.start, up, x.end, up, class_="grid"))
            body.append(svg.text(across, y.start + 15, words, class_="tick mid"))
            body.append(svg.text(x.start - 6, up + 3.5, words, class_="tick end"))
    return "".join(body)
