"""Mutants on trial: the suite runs until one of its scenarios notices the change."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path
from shutil import rmtree

from executive.record import History
from proving.coverage.seen import Seen
from proving.coverage.trials import Trial
from proving.coverage.universe import Universe
from proving.engine import Case, Ending, Limits
from proving.judge.verdict import Terms
from proving.mutation.account import Account, account
from proving.mutation.mutants import Mutant
from proving.suite.collect import Collected

SLOWER, GRACE_S = 3.0, 1800.0
"""A mutant may take this many times the mission time of the original, and this much more."""
WALL_SLOWER, WALL_GRACE_S = 10.0, 60.0


@dataclass(frozen=True)
class Baseline:
    """A scenario as it runs on the tree as it is; `reached` are the nodes that were ticked."""

    collected: Collected
    account: Account
    reached: frozenset[str]
    wall_s: float

    @property
    def file(self) -> Path:
        return self.collected.file

    @property
    def passed(self) -> bool:
        return self.account.verdict.good

    def reaches(self, node: str) -> bool:
        return any(name == node or name.startswith(f"{node}/") for name in self.reached)

    def limits(self) -> tuple[float, Limits]:
        """Mission and wall time that a mutant may take [s]."""
        mission_s = SLOWER * self.account.behaviour.mission_s + GRACE_S
        limit_s = min(mission_s, self.collected.scenario.time_limit_s)
        return limit_s, Limits(wall_s=WALL_SLOWER * self.wall_s + WALL_GRACE_S)


@dataclass(frozen=True)
class Found:
    """What became of a mutant: which scenario noticed, and what; None if it survived.

    A survivor was `changed` if some run went otherwise than before, within all that is expected.
    """

    mutant: Mutant
    killer: Path | None
    why: str
    runs: int
    changed: bool


@dataclass
class Court:
    """Runs scenarios on mutants; remembers which scenario has noticed most, to ask it first."""

    folder: Path
    tier: str | None
    overrides: tuple[str, ...]
    universe: Universe
    kills: Counter[tuple[Path, Path]] = field(default_factory=Counter)
    total: Counter[Path] = field(default_factory=Counter)
    numbers: Iterator[int] = field(default_factory=count)

    def baseline(self, collected: Collected) -> Trial[Baseline]:
        """The scenario on the tree as it is."""
        ending = yield self.case(collected)
        record, seen = ending.case.folder / "record.mcap", Seen()
        seen.add(collected.name, History.of(record) if record.is_file() else History.empty(), self.universe)
        reached = frozenset(item.name for item in seen.count if item.kind == "node")
        return Baseline(collected, self.close(ending, collected), reached, ending.wall_s)

    def trial(self, mutant: Mutant, suite: Sequence[Baseline]) -> Trial[Found]:
        """The scenarios that reach the changed node, the likeliest to notice first, until one does."""
        reaching, changed, runs = [b for b in suite if b.reaches(mutant.node)], False, 0
        while reaching:
            baseline = min(reaching, key=lambda b: self.rank(b, mutant))
            reaching.remove(baseline)
            runs += 1
            ending = yield self.case(baseline.collected, mutant, baseline)
            after = self.close(ending, baseline.collected)
            why = after.lost(baseline.account)
            if why is not None:
                self.kills[mutant.file, baseline.file] += 1
                self.total[baseline.file] += 1
                return Found(mutant, baseline.file, why, runs, True)
            changed = changed or after.behaviour != baseline.account.behaviour
        return Found(mutant, None, "" if runs else "no scenario reaches it", runs, changed)

    def close(self, ending: Ending, collected: Collected) -> Account:
        """The account of a case, whose folder goes."""
        told = account(ending, Terms.of(collected.scenario))
        rmtree(ending.case.folder, ignore_errors=True)
        return told

    def rank(self, baseline: Baseline, mutant: Mutant) -> tuple[float, ...]:
        kills, total = self.kills[mutant.file, baseline.file], self.total[baseline.file]
        return (-kills, -total, baseline.wall_s)

    def case(
        self, collected: Collected, mutant: Mutant | None = None, baseline: Baseline | None = None
    ) -> Case:
        key = str(next(self.numbers))
        case = Case(
            key, collected.file.absolute(), self.folder / key, tier=self.tier, overrides=self.overrides
        )
        if mutant is None or baseline is None:
            return case
        mission_s, limits = baseline.limits()
        overrides = (*self.overrides, f"time_limit={mission_s:.0f} s")
        return replace(case, overrides=overrides, limits=limits, instead=mutant.instead)
