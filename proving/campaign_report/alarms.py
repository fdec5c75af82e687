"""False alarms: what the executive held likely, and did, while no fault had taken effect."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from executive.report.figure import counted
from executive.report.tables import Table
from proving.campaign_report.case import RecordedCase
from proving.campaign_report.gather import RecordedCampaign


@dataclass(frozen=True)
class Alarms:
    """Over all mission time before any fault: cases with an alarm, alarms and remedies by name."""

    cases: int
    without_fault: int
    hours: float
    alarmed: tuple[int, ...]
    hypotheses: Counter[str]
    strategies: Counter[str]

    @property
    def total(self) -> int:
        return self.hypotheses.total()


def alarms(campaign: RecordedCampaign) -> Alarms:
    """Add up the alarms that `result.json` tells of as ones that no fault can have caused."""
    cases = campaign.counted
    found = {case.index: [alarm.hypothesis for alarm in case.result.false_alarms] for case in cases}
    return Alarms(
        cases=len(cases),
        without_fault=sum(not case.faults for case in cases),
        hours=sum(case.quiet_s for case in cases) / 3600,
        alarmed=tuple(index for index, names in found.items() if names),
        hypotheses=Counter(name for names in found.values() for name in names),
        strategies=Counter(name for case in cases for name in _tried(case)),
    )


def _tried(case: RecordedCase) -> list[str]:
    """The strategies chosen before any fault took effect."""
    return [row.name for row in case.result.strategies if row.t_s < case.quiet_s]


def alarm_table(found: Alarms) -> Table:
    """Each hypothesis that led without a fault, how often, and how often an hour."""
    rows = tuple(
        (name.replace("_", " "), str(count), f"{count / found.hours:.2f}" if found.hours else "–")
        for name, count in found.hypotheses.most_common()
    )
    tried = (
        ", ".join(f"{name} {counted(count, 'time')}" for name, count in found.strategies.most_common())
        or "none"
    )
    note = (
        f"From {found.hours:.1f} h of mission time before any fault took effect: the whole of "
        f"{counted(found.without_fault, 'case')} without a fault, the beginnings of "
        f"{counted(found.cases - found.without_fault, 'case')} with one. "
        f"{counted(len(found.alarmed), 'case')} had an alarm: another hypothesis than the nominal one led. "
        f"Strategies tried in that time: {tried}. Loose sand and poor views are real, so that not every "
        "alarm is an error; but each costs time."
    )
    header = ("held likely without a fault", "times", "per hour")
    return Table("alarms", "False alarms", header, rows or (("none", "0", "0"),), note)
