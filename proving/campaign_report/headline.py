"""The figures at the head of a campaign's report."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from executive.record import FaultStages
from executive.report.figure import counted, duration
from executive.report.tiles import Tile
from proving.campaign_report.alarms import Alarms
from proving.campaign_report.case import INFRASTRUCTURE
from proving.campaign_report.gather import RecordedCampaign
from proving.campaign_report.groups import success
from proving.campaign_report.lengths import length

_CLASSES = {INFRASTRUCTURE: "lost to the infrastructure", "sut": "broke the system under test"}


def headline(campaign: RecordedCampaign) -> list[Tile]:
    """The three figures that matter most: safety, success, cases."""
    unsafe = [case for case in campaign.cases if case.unsafe]
    known = sum(case.found is not None for case in campaign.cases)
    worst = ", ".join(f"case {case.index}" for case in unsafe[:4]) + (" …" if len(unsafe) > 4 else "")
    safety = "safety violation" if len(unsafe) == 1 else "safety violations"
    return [
        Tile(
            safety,
            str(len(unsafe)),
            worst or f"in {counted(known, 'case')} judged",
            "bad" if unsafe else "good",
        ),
        _success(campaign),
        Tile("cases", str(len(campaign.cases)), _classes(campaign)),
    ]


def tiles(campaign: RecordedCampaign, alarms: Alarms) -> list[Tile]:
    """The rest, a row of smaller ones."""
    fired = [row for case in campaign.counted for row in case.faults if row.fired]
    errors = [e for case in campaign.counted if (e := case.result.truth.final_error_m) is not None]
    shares = [s for case in campaign.counted if (s := case.cross_share) is not None]
    mission_s = [case.result.mission_s for case in campaign.cases]
    per_hour = f"{alarms.total / alarms.hours:.2f} an hour" if alarms.hours else "no time without a fault"
    median = float(np.median(errors)) if errors else None
    return [
        Tile("faults injected", str(len(fired)), f"{len({row.kind for row in fired})} kinds"),
        _isolated(fired),
        Tile("false alarms", str(alarms.total) if alarms.cases else "–", per_hour),
        Tile("true error at the end", length(median), _tail(errors)),
        Tile("nearest to the margin", f"{max(shares):.2f}" if shares else "–", "cross-track / off-track"),
        Tile("mission time", duration(sum(mission_s)), _wall(campaign)),
    ]


def _success(campaign: RecordedCampaign) -> Tile:
    found = success(campaign.counted)
    if math.isnan(found.value):
        return Tile("success", "–", "no case counts")
    hits = sum(case.passed for case in campaign.counted)
    interval = f"95 % interval {100 * found.low:.1f} to {100 * found.high:.1f} %"
    words = [f"{hits} of {len(campaign.counted)}; {interval}"]
    untested = [case.result.ended_as for case in campaign.cases if case.outcome == "invalid"]
    if untested:
        both = f"{hits + untested.count('reached')} of {len(campaign.counted) + len(untested)}"
        words.append(f"{both} with those in which a fault never fired")
    return Tile("success", f"{100 * found.value:.1f} %", "; ".join(words))


def _classes(campaign: RecordedCampaign) -> str:
    """How many were lost, and to what."""
    classes = Counter(case.class_ for case in campaign.cases if case.class_)
    invalid = sum(case.outcome == "invalid" for case in campaign.cases)
    parts = [f"{n} {_CLASSES.get(name, name)}" for name, n in sorted(classes.items())]
    if invalid:
        parts.append(f"{invalid} invalid")
    planned = campaign.about.get("total")
    if isinstance(planned, int) and len(campaign.cases) < planned:
        parts.append(f"{planned} planned")
    return ", ".join(parts) or "none lost, none invalid"


def _isolated(fired: list[FaultStages]) -> Tile:
    right = sum(row.concluded is not None and row.concluded == row.expected for row in fired)
    asked = sum(row.expected is not None for row in fired)
    value = f"{100 * right / asked:.0f} %" if asked else "–"
    return Tile("diagnosed as expected", value, f"{right} of {asked}")


def _tail(errors: list[float]) -> str:
    if not errors:
        return "median"
    return f"median; 95 % below {length(float(np.percentile(errors, 95)))}"


def _wall(campaign: RecordedCampaign) -> str:
    wall_s = sum((case.result.wall_s or 0.0) for case in campaign.cases)
    return f"in {duration(wall_s)} of computing".replace("\u00a0", " ")
