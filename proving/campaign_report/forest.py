"""Success with its interval and the kinds of end, fault by fault."""

from __future__ import annotations

from html import escape

from executive.report import svg
from executive.report.axes import Scale, legend
from executive.report.figure import Figure, counted
from proving.campaign_report.case import RecordedCase
from proving.campaign_report.gather import RecordedCampaign
from proving.campaign_report.groups import ENDS, SERIES, Group, by_fault, ends, success

_WIDTH, _LEFT, _TOP, _ROW = 1100.0, 216.0, 34.0, 30.0
_PLOT = Scale(0.0, 1.0, _LEFT + 46, 600.0)
_WORDS = 690.0
_BAR = Scale(0.0, 1.0, 706.0, _WIDTH - 4)


def forest(campaign: RecordedCampaign) -> Figure | None:
    """A row per fault: cases, success with interval per setting, composition of ends."""
    if not campaign.cases:
        return None
    groups, settings = by_fault(campaign), campaign.settings
    rows, y = [], _TOP
    for number, group in enumerate(groups):
        height = max(_ROW, 17.0 * len(settings) + 10)
        rows.append(_row(group, settings, y, height))
        if number == 0:
            rows.append(svg.line(0, y + height, _WIDTH, y + height, class_="rule"))
        y += height
    overall = success(campaign.cases).value
    body = [_axis(y), _mean(overall, y), *rows]
    drawn = svg.drawing(_WIDTH, y + 24, body, aria_label="Success by fault")
    entries = [("dot", SERIES[n % 4], escape(name)) for n, name in enumerate(settings) if name]
    entries += [
        ("solid", colour, words) for end, (words, colour) in ENDS.items() if end in ends(campaign.cases)
    ]
    return Figure("success", "Success by fault", legend(entries) + drawn, _caption(campaign))


def _caption(campaign: RecordedCampaign) -> str:
    uncounted = len(campaign.cases) - len(campaign.counted)
    left_out = (
        f" {counted(uncounted, 'case')} on the right not counted on the left: lost to the infrastructure, or "
        "a fault never fired."
        if uncounted
        else ""
    )
    return (
        "Left, the share of cases that passed, with its 95 % Wilson interval; the dashed line is the share "
        "over all cases. Right, how the cases ended. Faults are sorted by success, the hardest first; a case "
        f"with two faults counts under each.{left_out}"
    )


def _axis(bottom: float) -> str:
    head = svg.text(_PLOT.start, 14, "passed", class_="axis") + svg.text(
        _BAR.start, 14, "ended", class_="axis"
    )
    marks = [
        svg.line(_PLOT(v), _TOP - 8, _PLOT(v), bottom, class_="grid")
        + svg.text(_PLOT(v), bottom + 16, f"{v:.0%}".replace("%", " %"), class_="tick mid")
        for v in (0.0, 0.25, 0.5, 0.75, 1.0)
    ]
    return head + svg.text(_LEFT + 10, 14, "cases", class_="axis end") + "".join(marks)


def _mean(value: float, bottom: float) -> str:
    if value != value:
        return ""
    return svg.line(_PLOT(value), _TOP - 8, _PLOT(value), bottom, class_="mean")


def _row(group: Group, settings: tuple[str, ...], y: float, height: float) -> str:
    middle = y + height / 2
    name = group.label.replace("_", " ")
    body = [
        svg.text(0, middle + 4, name, class_="lane"),
        svg.text(_LEFT + 10, middle + 4, str(len(group.cases)), class_="tick end"),
        _bar(list(group.cases), middle),
    ]
    step = 17.0
    for n, setting in enumerate(settings):
        cases = [case for case in group.cases if case.setting == setting]
        body.append(_interval(cases, middle + (n - (len(settings) - 1) / 2) * step, SERIES[n % 4]))
    return "".join(body)


def _interval(cases: list[RecordedCase], y: float, colour: str) -> str:
    counted = [case for case in cases if case.counts]
    if not counted:
        return svg.text(_WORDS, y + 4, "none counted", class_="tick end")
    found = success(counted)
    hits = sum(case.passed for case in counted)
    said = f"{hits} of {len(counted)} passed, {found.value:.1%}, interval {found.low:.1%} to {found.high:.1%}"
    return svg.element(
        "g",
        svg.title(said),
        svg.line(
            _PLOT(found.low), y, _PLOT(found.high), y, stroke=colour, stroke_width=2.4, stroke_linecap="round"
        ),
        svg.element("circle", cx=_PLOT(found.value), cy=y, r=5.2, fill=colour, class_="halo"),
        svg.text(_WORDS, y + 4, f"{hits}/{len(counted)}", class_="tick end"),
    )


def _bar(cases: list[RecordedCase], middle: float) -> str:
    body, start = [], 0.0
    for end, count in ends(cases).items():
        words, colour = ENDS[end]
        left, width = _BAR(start), count / len(cases) * (_BAR.end - _BAR.start)
        inside = svg.text(left + width / 2, middle + 4, str(count), class_="inside") if width > 20 else ""
        body.append(
            svg.element(
                "g",
                svg.title(f"{words}: {count} of {len(cases)}"),
                svg.element(
                    "rect", x=left, y=middle - 9, width=max(width - 1, 0.6), height=18.0, fill=colour
                ),
                inside,
            )
        )
        start += count / len(cases)
    return "".join(body)
