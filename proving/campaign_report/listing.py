"""Every case in one table, with plain keys to sort by."""

from __future__ import annotations

import math
from typing import NamedTuple

from executive.report.figure import duration
from proving.campaign_report.case import RecordedCase
from proving.campaign_report.gather import RecordedCampaign
from proving.campaign_report.groups import ENDS, end_of
from proving.campaign_report.lengths import length
from proving.campaign_report.worst import command


class Cell(NamedTuple):
    """What a cell shows, what it is sorted by, and its class."""

    text: str
    key: str
    class_: str = ""


HEADER = (
    *("case", "setting", "seed", "faults", "ended", "verdict", "true error", "cross/margin"),
    *("tilt", "strategies", "diagnosed", "mission time", "repeat"),
)


def rows(campaign: RecordedCampaign) -> list[tuple[Cell, ...]]:
    """A row per case, in the order of their numbers."""
    return [_row(campaign, case) for case in campaign.cases]


def _row(campaign: RecordedCampaign, case: RecordedCase) -> tuple[Cell, ...]:
    error, share, tilt = case.result.truth.final_error_m, case.cross_share, case.result.truth.max_tilt_deg
    mission_s = case.result.mission_s if case.found is not None else None
    diagnosed = sorted({row.concluded for row in case.faults if row.concluded})
    return (
        _number(case.index, str(case.index)),
        _text(case.setting or "–"),
        _number(case.seed, str(case.seed) if case.seed is not None else "–"),
        _text(", ".join(case.kinds) or "–"),
        _text(ENDS[end_of(case)][0]),
        _verdict(case),
        _number(error, length(error)),
        _number(share, "–" if share is None else f"{share:.2f}"),
        _number(tilt, "–" if tilt is None else f"{tilt:.1f}°"),
        _text(", ".join(row.name for row in case.result.strategies) or "–"),
        _text(", ".join(diagnosed) or "–"),
        _number(mission_s, "–" if mission_s is None else duration(mission_s)),
        Cell(command(campaign, case), str(case.index), "code"),
    )


def _verdict(case: RecordedCase) -> Cell:
    if case.unsafe:
        return Cell("unsafe", "0", "bad")
    words = str(case.note.verdict or ("passed" if case.passed else "failed"))
    if case.class_:
        words += f" ({case.class_})"
    return Cell(words, "2" if case.passed else "1", "good" if case.passed else "care")


def _text(words: str) -> Cell:
    return Cell(words.replace("_", " "), words)


def _number(value: float | None, words: str) -> Cell:
    missing = value is None or math.isnan(value)
    return Cell(words, "" if missing else f"{value:.9g}", "number")
