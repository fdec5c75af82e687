"""False alarms: what the executive held likely, and did, while no fault had been injected."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from executive.errors import RecordError
from executive.report.tables import Table
from executive.telemetry import History
from executive.telemetry.evidence import episodes
from proving.campaign_report.case import Case
from proving.campaign_report.gather import Campaign


@dataclass(frozen=True)
class Alarms:
    """Over all cases without a fault: mission time, cases with an alarm, alarms and remedies by name."""

    cases: int
    hours: float
    alarmed: tuple[int, ...]
    hypotheses: Counter[str]
    strategies: Counter[str]

    @property
    def total(self) -> int:
        return self.hypotheses.total()


def alarms(campaign: Campaign) -> Alarms:
    """Read the records of the cases without a fault. An alarm begins when the nominal ceases to lead."""
    quiet = [case for case in campaign.counted if not case.faults]
    found = {case.index: _alarms(case) for case in quiet}
    hours = sum(float(case.result.get("mission_s") or 0.0) for case in quiet) / 3600
    strategies = Counter(str(row["name"]) for case in quiet for row in case.result.get("strategies") or [])
    total: Counter[str] = Counter()
    for counted in found.values():
        total.update(counted)
    return Alarms(len(quiet), hours, tuple(i for i, c in found.items() if c), total, strategies)


def _alarms(case: Case) -> Counter[str]:
    """The hypotheses that took over from the nominal one, one count each time."""
    try:
        return Counter(at.event for at in episodes(History.of(case.folder / "record.mcap")))
    except RecordError:
        return Counter()


def alarm_table(found: Alarms) -> Table:
    """Each hypothesis that was wrongly thought to lead, how often, and how often an hour."""
    rows = tuple(
        (name.replace("_", " "), str(count), f"{count / found.hours:.2f}" if found.hours else "–")
        for name, count in found.hypotheses.most_common()
    )
    tried = ", ".join(f"{name} {count} times" for name, count in found.strategies.most_common()) or "none"
    note = (
        f"From the {found.cases} cases without a fault, {found.hours:.1f} h of mission time: "
        f"{len(found.alarmed)} of them had an alarm: some hypothesis other than the nominal one led. "
        f"Strategies tried in them: {tried}. Loose sand and poor views are real, so that not every alarm "
        "is an error; an alarm without a fault is still one that costs time."
    )
    header = ("held likely without a fault", "times", "per hour")
    return Table("alarms", "False alarms", header, rows or (("none", "0", "0"),), note)
