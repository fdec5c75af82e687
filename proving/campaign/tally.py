"""What a campaign has come to so far: counts, shares with intervals, and whether that is enough."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from executive.core.errors import LongarmError
from proving.campaign.interval import wilson
from proving.campaign.shape import StopRule
from proving.engine import CaseClass
from proving.judge.verdict import GOOD, Word


@dataclass(frozen=True)
class Ended:
    """One case that has ended, as the journal tells it."""

    number: int
    setting: str
    seed: int
    verdict: str
    kind: str
    cause: str
    outcome: str
    wall_s: float
    inside_s: float
    digest: str
    ended_as: str = ""
    """The outcome behind `invalid`; else the outcome."""

    @property
    def good(self) -> bool:
        return self.verdict in GOOD

    @property
    def counts(self) -> bool:
        """Whether it says anything of the system: not if it was the infrastructure, or tested nothing."""
        return self.verdict != Word.INVALID and self.kind in (CaseClass.OK, CaseClass.SUT)

    def to_json(self) -> dict[str, object]:
        """A line of the journal."""
        rest = {name: value for name, value in vars(self).items() if name not in ("number", "kind")}
        return {"event": "ended", "case": self.number, "class": self.kind, **rest}

    @classmethod
    def from_json(cls, line: dict[str, Any]) -> Ended:
        """The case that a line of the journal tells of."""
        rest = {name: value for name, value in line.items() if name not in ("event", "case", "class")}
        try:
            return cls(number=line["case"], kind=line["class"], **rest)
        except (KeyError, TypeError) as error:
            raise LongarmError(f"got a journal line that cannot be read: {error}") from None


@dataclass
class Tally:
    """The cases that have ended, by number."""

    ended: dict[int, Ended] = field(default_factory=dict)

    def add(self, case: Ended) -> None:
        self.ended[case.number] = case

    def verdicts(self) -> dict[str, int]:
        """How many cases came to each verdict, best first."""
        counts = Counter(case.verdict for case in self.ended.values())
        return {str(word): counts[word] for word in Word if counts[word]}

    def classes(self) -> dict[str, int]:
        return dict(Counter(case.kind for case in self.ended.values()))

    def shares(self, confidence: float = 0.95) -> dict[str, dict[str, Any]]:
        """For each setting the share of good verdicts with its interval, of the cases that count.

        Beside it `untested`, the cases in which a fault never fired, and how many of them reached the goal.
        """
        settings = dict.fromkeys(case.setting for _, case in sorted(self.ended.items()))
        return {name: self._share(name, confidence) for name in settings}

    def _share(self, setting: str, confidence: float) -> dict[str, Any]:
        cases = [case for case in self.ended.values() if case.setting == setting]
        untested = [case.ended_as for case in cases if case.verdict == Word.INVALID]
        beside = {"untested": len(untested), "untested_reached": untested.count("reached")}
        return _share([case.good for case in cases if case.counts], confidence) | beside

    def outside_share(self) -> float | None:
        """Share of the cases' wall time outside the simulation's step and the executive's tick."""
        done = [case for case in self.ended.values() if case.inside_s > 0.0]
        total_s = sum(case.wall_s for case in done)
        return 1.0 - sum(case.inside_s for case in done) / total_s if total_s else None

    def enough(self, rule: StopRule | None) -> bool:
        """Whether each setting's interval is narrow enough, judged from the cases before the first gap.

        So it does not depend on the order in which cases happen to end.
        """
        if rule is None:
            return False
        prefix = Tally()
        while (case := self.ended.get(len(prefix.ended))) is not None:
            prefix.add(case)
        widths = [s["interval"][1] - s["interval"][0] for s in prefix.shares(rule.confidence).values()]
        return bool(widths) and max(widths) < rule.interval


def _share(good: list[bool], confidence: float) -> dict[str, Any]:
    low, high = wilson(sum(good), len(good), confidence) if good else (0.0, 1.0)
    return {
        "cases": len(good),
        "good": sum(good),
        "share": sum(good) / len(good) if good else None,
        "confidence": confidence,
        "interval": [low, high],
    }
