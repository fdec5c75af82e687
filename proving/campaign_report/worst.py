"""The worst cases, each with its map, what happened in a line, and the command that repeats it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from html import escape

from executive.report.axes import legend
from executive.report.figure import Figure, duration
from executive.report.palette import BAD, ESTIMATE, TRUTH
from proving.campaign_report.case import INFRASTRUCTURE, LOST, RecordedCase
from proving.campaign_report.gather import RecordedCampaign
from proving.campaign_report.groups import ENDS, end_of
from proving.campaign_report.lengths import length
from proving.campaign_report.thumbnail import thumbnail

MOST = 12
_ORDER = ("error", LOST, "time_limit", "safe_hold", "help", "otherwise", "invalid", "reached")
_PATH = re.compile(r"[\w#]+(?:/[\w#]+)+/([\w#]+)")


def ranked(cases: Iterable[RecordedCase]) -> list[RecordedCase]:
    """Worst first: broken safety, the kind of end, the true error at the end; the infrastructure's last."""
    return sorted(
        cases,
        key=lambda case: (
            not case.unsafe,
            case.class_ == INFRASTRUCTURE,
            _ORDER.index(end_of(case)),
            -(case.result.truth.final_error_m or 0.0),
            case.index,
        ),
    )


def worst(campaign: RecordedCampaign) -> Figure | None:
    """Up to a dozen cards; None where there is no case at all."""
    chosen = _unlike(ranked(campaign.cases))[:MOST]
    if not chosen:
        return None
    cards = "".join(_card(campaign, case) for case in chosen)
    words = [
        ("line", TRUTH, "true track"),
        ("dash", ESTIMATE, "believed track"),
        ("dot", BAD, "where it truly ended"),
    ]
    caption = (
        "Ordered by broken safety expectations, then by how the case ended, then by its true error at the "
        "end. The bands are the on-track and off-track margins, the rings the tolerance zones of the "
        "way-points. The command repeats the case bit for bit."
        + (_ONE_OF_EACH if len(campaign.settings) > 1 else "")
    )
    return Figure("worst", "Worst cases", legend(words) + f"<div class='worst'>{cards}</div>", caption)


_ONE_OF_EACH = " Of safe cases that met the same conditions under several settings the worst stands for all."


def _unlike(cases: list[RecordedCase]) -> list[RecordedCase]:
    """The first case of every seed, and every unsafe one."""
    seen: set[int | None] = set()
    kept = []
    for case in cases:
        if case.unsafe or case.seed is None or case.seed not in seen:
            kept.append(case)
        seen.add(case.seed)
    return kept


def command(campaign: RecordedCampaign, case: RecordedCase) -> str:
    """What repeats the case, from the folder that the campaign folder lies in."""
    return f"longarm campaign rerun {campaign.folder.name} {case.index}"


def story(case: RecordedCase) -> str:
    """What happened, in one line: the faults, how it ended and why, what was broken."""
    faults = ", ".join(_fault(row.kind, row.t_on_s, row.fired) for row in case.faults) or "no fault"
    tried = len(case.result.strategies)
    remedies = f"; {tried} {'strategy' if tried == 1 else 'strategies'} tried" if tried else ""
    broken = "; ".join(case.unsafe)
    return f"{faults}{remedies}; {_ending(case)}" + (f". Unsafe: {broken}" if broken else "")


def _fault(kind: str, t_on_s: float | None, fired: bool) -> str:
    name = kind.replace("_", " ")
    return f"{name} at {duration(t_on_s)}" if fired and t_on_s is not None else f"{name} (never fired)"


def _ending(case: RecordedCase) -> str:
    if case.outcome == LOST:
        cause = case.note.detail or case.note.cause or "left no result"
        return f"lost ({case.class_ or 'unknown'}): {cause}"
    if case.result.reason:
        why = _PATH.sub(r"\1", str(case.result.reason))  # of a node's path its name is enough
        return f"{ENDS[end_of(case)][0]}: {why}"
    unmet = [row.text for row in case.result.expectations if not row.met]
    return f"{ENDS[end_of(case)][0]}" + (f", but not {unmet[0]}" if unmet else "")


def _card(campaign: RecordedCampaign, case: RecordedCase) -> str:
    words, colour = ENDS[end_of(case)]
    error = case.result.truth.final_error_m
    figures = [
        f"error {length(error)}",
        f"cross-track {_share(case.cross_share)} of the margin",
        f"tilt {_degrees(case.result.truth.max_tilt_deg)}",
    ]
    setting = f" · {escape(case.setting)}" if case.setting else ""
    flag = "<span class='flag'>unsafe</span>" if case.unsafe else ""
    return (
        f"<div class='case' id='case-{case.index}'>{thumbnail(case)}"
        f"<p class='name'><b>case {case.index}</b>{setting}"
        f"<i style='background:{colour}'></i>{escape(words)}{flag}</p>"
        f"<p class='story'>{escape(story(case))}</p><p class='figures'>{' · '.join(figures)}</p>"
        f"<code>{escape(command(campaign, case))}</code></div>"
    )


def _share(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"


def _degrees(value: float | None) -> str:
    return "–" if value is None or math.isnan(value) else f"{value:.1f}°"
