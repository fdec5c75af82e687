"""Cases put together by fault, and the kinds of end that they came to."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from proving.campaign_report.case import LOST, RecordedCase
from proving.campaign_report.gather import RecordedCampaign
from proving.campaign_report.statistics import Estimate, share

SERIES = ("var(--s0)", "var(--s1)", "var(--s2)", "var(--s3)")
"""One colour per setting, in order."""

ENDS = {
    "reached": ("reached, as expected", "var(--good)"),
    "otherwise": ("reached, not as expected", "#8d9c3f"),
    "help": ("called for help", "#d7a13a"),
    "safe_hold": ("safe hold", "#a9760f"),
    "time_limit": ("time limit", "#7b4f9d"),
    "error": ("error", "var(--bad)"),
    LOST: ("lost", "#5a3030"),
    "invalid": ("invalid: a fault never fired", "#a0a7ad"),
}
"""Kinds of end, best first: words and colour."""


class Group(NamedTuple):
    """Some cases and what they have in common."""

    label: str
    cases: Sequence[RecordedCase]


def by_fault(campaign: RecordedCampaign) -> list[Group]:
    """All cases, those without a fault, then those with each kind of fault, the least successful first.

    A case with two kinds counts under both.
    """
    groups = [Group(kind, [c for c in campaign.cases if kind in c.kinds]) for kind in campaign.kinds]
    groups.sort(key=lambda group: (-1.0 if not _any(group) else success(group.cases).value, group.label))
    without = [case for case in campaign.cases if not case.kinds]
    head = [Group("all cases", campaign.cases)]
    return head + ([Group("without a fault", without)] if without else []) + groups


def _any(group: Group) -> bool:
    return any(case.counts for case in group.cases)


def success(cases: Iterable[RecordedCase]) -> Estimate:
    """The share of the counted cases that passed."""
    counted = [case for case in cases if case.counts]
    return share(sum(case.passed for case in counted), len(counted))


def end_of(case: RecordedCase) -> str:
    """The kind of end a case came to."""
    if case.outcome == "reached" and not case.passed:
        return "otherwise"
    return case.outcome if case.outcome in ENDS else "error"


def ends(cases: Iterable[RecordedCase]) -> dict[str, int]:
    """How often each kind of end came, in the order of ENDS; those that never came left out."""
    counted = Counter(end_of(case) for case in cases)
    return {end: counted[end] for end in ENDS if counted[end]}
