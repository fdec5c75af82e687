"""The search for scenarios that fill holes: the suite first, then a candidate for each hole in turn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from shutil import rmtree

from executive.pool import Strategy
from executive.record import History
from executive.run import ResolvedScenario
from proving.coverage.bases import Base, candidates, resolved_or_none
from proving.coverage.coverage import Coverage, put_together
from proving.coverage.excuses import Excuses
from proving.coverage.items import Item
from proving.coverage.seen import Seen
from proving.coverage.universe import Universe
from proving.engine import Case, Ending, settle
from proving.judge.verdict import Terms, Verdict, Word, judged
from proving.scenario_data import Data, read_back


@dataclass(frozen=True)
class Proposal:
    """A scenario that fills holes; or one that went wrong while one was looked for, and `wrong` says how."""

    data: Data
    fills: tuple[Item, ...]
    shows: frozenset[Item]
    outcome: str
    wrong: str = ""


@dataclass
class Search:
    """Hands out cases as long as runs are left, and is told of each that has ended.

    `most` is how many it may hand out beside the suite's own.
    """

    folder: Path
    universe: Universe
    suite: list[ResolvedScenario]
    excuses: Excuses
    strategies: dict[str, Strategy]
    most: int
    seen: Seen = field(default_factory=Seen)
    bases: list[Base] = field(default_factory=list)
    under_way: dict[str, ResolvedScenario] = field(default_factory=dict)
    tried: set[str] = field(default_factory=set)
    hopeless: dict[Item, int] = field(default_factory=dict)
    """Holes without a candidate that was not tried, and how many bases there were then."""
    given: int = 0
    ended: int = 0
    turn: int = 0

    def __iter__(self) -> Iterator[Case]:
        return self

    def __next__(self) -> Case:
        if self.given < len(self.suite):
            return self._case(self.suite[self.given])
        if self.ended < len(self.suite) or self.given - len(self.suite) >= self.most:
            raise StopIteration  # for now: what there is to fill is not known yet; or for good
        return self._next_candidate()

    def hear(self, ending: Ending) -> Proposal | None:
        """Take in a run that has ended; the proposal, if it is one."""
        scenario, of_suite = self.under_way.pop(ending.case.key), int(ending.case.key) < len(self.suite)
        self.ended += 1
        result = settle(ending)
        verdict = judged(ending, result, Terms.of(scenario))
        record = ending.case.folder / "record.mcap"
        history = History.of(record) if record.is_file() else History.empty()
        rmtree(ending.case.folder, ignore_errors=True)
        alone = Seen()
        alone.add(scenario.name, history, self.universe)
        fills = tuple(hole for hole in self.coverage().holes() if hole in alone.count)
        wrong = "" if of_suite else _wrong(verdict)
        useful = bool(fills) and verdict.word is not Word.INVALID and not wrong
        data = read_back(scenario)
        if of_suite or useful:
            self.seen.add(scenario.name, history, self.universe)
            self.bases.append(Base.of(data, history, self.universe))
        if of_suite or not (useful or wrong):
            return None
        return Proposal(data, fills, frozenset(alone.count), result.outcome, wrong)

    def coverage(self) -> Coverage:
        """Of the suite and of what was found so far."""
        return put_together(self.universe, self.seen, self.excuses)

    def _next_candidate(self) -> Case:
        holes = self.coverage().holes()
        for step in range(len(holes)):
            hole = holes[(self.turn + step) % len(holes)]
            if self.hopeless.get(hole) == len(self.bases):
                continue
            for data in candidates(hole, self.bases, self.strategies):
                scenario = None if str(data) in self.tried else resolved_or_none(data)
                self.tried.add(str(data))
                if scenario is not None:
                    self.turn += step + 1
                    return self._case(scenario)
            self.hopeless[hole] = len(self.bases)
        raise StopIteration

    def _case(self, scenario: ResolvedScenario) -> Case:
        key = str(self.given)
        self.given += 1
        file = self.folder / f"{key}.yaml"
        file.write_text(scenario.dump())
        self.under_way[key] = scenario
        return Case(key, file, self.folder / key)


def _wrong(verdict: Verdict) -> str:
    unsafe = verdict.word is Word.FAILED and verdict.message.startswith("unsafe")
    return verdict.message if unsafe or verdict.word is Word.ERROR else ""
