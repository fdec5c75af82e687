"""How near each case came to a limit: the off-track margin, and tipping over."""

from __future__ import annotations

from executive.report import svg
from executive.report.axes import Scale, legend, ticks
from executive.report.figure import Figure
from proving.campaign_report.case import RecordedCase
from proving.campaign_report.gather import RecordedCampaign

_WIDTH, _LEFT, _TOP, _BOTTOM = 1100.0, 52.0, 30.0, 330.0


def margins(campaign: RecordedCampaign) -> Figure | None:
    """Worst tilt over worst cross-track error, a dot a case; None where no truth is known."""
    placed = [
        (case, x, y)
        for case in campaign.cases
        if (x := case.cross_share) is not None and (y := case.result.truth.max_tilt_deg) is not None
    ]
    if not placed:
        return None
    across = Scale(0.0, max(1.12, 1.05 * max(x for _, x, _ in placed)), _LEFT, _WIDTH - 8)
    limit = min((deg for case, _, _ in placed if (deg := case.tilt_limit_deg) is not None), default=None)
    up = Scale(0.0, 1.12 * max(9.0, limit or 0.0, max(y for _, _, y in placed)), _BOTTOM, _TOP)
    body = [_frame(across, up), _limit(across, up, limit)]
    body += [_dot(case, across(x), up(y)) for case, x, y in sorted(placed, key=lambda p: bool(p[0].unsafe))]
    drawn = svg.drawing(_WIDTH, _BOTTOM + 40, body, aria_label="Margins")
    words = [
        ("dot", "var(--good)", "passed"),
        ("dot", "#d7a13a", "did not pass, stayed safe"),
        ("mark", "var(--bad)", "broke a safety expectation"),
    ]
    worst, tilt = max(x for _, x, _ in placed), max(y for _, _, y in placed)
    caption = (
        "Each dot is a case: its largest true cross-track error in units of the off-track margin, and its "
        f"largest true tilt. The worst came to {worst:.2f} of the margin and to {tilt:.1f}° of tilt. The red "
        "lines are the limits. Beyond the margin the rover may come to stand, where the ground moves it; "
        "driving on there under autonomous command breaks a safety expectation."
    )
    return Figure("margins", "Margins", legend(words) + drawn, caption)


def _frame(across: Scale, up: Scale) -> str:
    body = [
        svg.element(
            "rect",
            x=across(1.0),
            y=_TOP,
            width=max(across.end - across(1.0), 0.0),
            height=_BOTTOM - _TOP,
            fill="var(--bad)",
            fill_opacity=0.09,
        ),
    ]
    for x in ticks(0.0, across.high, 8):
        body.append(svg.line(across(x), _TOP, across(x), _BOTTOM, class_="grid"))
        body.append(svg.text(across(x), _BOTTOM + 15, f"{x:g}", class_="tick mid"))
    for y in ticks(0.0, up.high, 5):
        body.append(svg.line(_LEFT, up(y), across.end, up(y), class_="grid"))
        body.append(svg.text(_LEFT - 6, up(y) + 3.5, f"{y:g}", class_="tick end"))
    body.append(svg.line(across(1.0), _TOP, across(1.0), _BOTTOM, stroke="var(--bad)", stroke_width=1.6))
    body.append(svg.text(_LEFT, 14, "largest tilt [deg]", class_="axis"))
    body.append(
        svg.text(across.end, _BOTTOM + 33, "largest cross-track error / off-track margin", class_="axis end")
    )
    return "".join(body)


def _limit(across: Scale, up: Scale, limit_deg: float | None) -> str:
    """The tilt beyond which the rover is not safe, where the scenarios say it."""
    if limit_deg is None:
        return ""
    size = {"x": _LEFT, "y": _TOP, "width": across.end - _LEFT, "height": max(up(limit_deg) - _TOP, 0.0)}
    beyond = svg.element("rect", **size, fill="var(--bad)", fill_opacity=0.09)
    return beyond + svg.line(
        _LEFT, up(limit_deg), across.end, up(limit_deg), stroke="var(--bad)", stroke_width=1.6
    )


def _dot(case: RecordedCase, x: float, y: float) -> str:
    said = svg.title(f"case {case.index}: {', '.join(case.kinds) or 'no fault'}, {case.outcome}")
    if case.unsafe:
        corners = [(x, y - 7), (x + 7, y), (x, y + 7), (x - 7, y)]
        return svg.element("g", said, svg.polygon(corners, fill="var(--bad)", class_="halo"))
    colour = "var(--good)" if case.passed else "#d7a13a"
    return svg.element("g", said, svg.element("circle", cx=x, cy=y, r=3.4, fill=colour, fill_opacity=0.75))
