"""Mutants on trial: the suite runs until one of its scenarios notices the change."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from shutil import rmtree

from executive.telemetry.history import History
from proving.coverage.run import Case
from proving.coverage.seen import Seen
from proving.coverage.suite import Verdict, verdict_of
from proving.coverage.trials import Trial
from proving.coverage.universe import Universe
from proving.mutation.mutants import Mutant

SLOWER, GRACE_S = 3.0, 1800.0
"""A mutant may take this many times the mission time of the original, and this much more."""
WALL_SLOWER, WALL_GRACE_S = 10.0, 60.0


@dataclass(frozen=True)
class Baseline:
    """A scenario as it runs on the tree as it is; `reached` are the nodes that were ticked."""

    file: Path
    verdict: Verdict
    reached: frozenset[str]
    mission_s: float
    wall_s: float

    def reaches(self, node: str) -> bool:
        return any(name == node or name.startswith(f"{node}/") for name in self.reached)


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

    def baseline(self, file: Path) -> Trial[Baseline]:
        """The scenario on the tree as it is."""
        case = self.case(file)
        ended = yield case
        seen = Seen()
        if ended.result is not None:
            seen.add(str(file), History.of(case.folder / "record.mcap"), self.universe)
        rmtree(case.folder, ignore_errors=True)
        reached = frozenset(item.name for item in seen.count if item.kind == "node")
        told = ended.result or {"mission_s": 0.0, "wall_s": 0.0}
        return Baseline(file, verdict_of(ended), reached, told["mission_s"], told["wall_s"])

    def trial(self, mutant: Mutant, suite: Sequence[Baseline]) -> Trial[Found]:
        """The scenarios that reach the changed node, the likeliest to notice first, until one does."""
        reaching = [b for b in suite if b.reaches(mutant.node)]
        changed = False
        for number in range(len(reaching)):
            baseline = min(reaching, key=lambda b: self.rank(b, mutant))
            reaching.remove(baseline)
            case = self.case(baseline.file, mutant, baseline)
            ended = yield case
            rmtree(case.folder, ignore_errors=True)
            verdict = verdict_of(ended)
            why = verdict.worse_than(baseline.verdict)
            if why is not None:
                self.kills[mutant.file, baseline.file] += 1
                self.total[baseline.file] += 1
                return Found(mutant, baseline.file, why, number + 1, True)
            changed = changed or verdict.behaviour != baseline.verdict.behaviour
        runs = sum(b.reaches(mutant.node) for b in suite)
        return Found(mutant, None, "no scenario reaches it" if not runs else "", runs, changed)

    def rank(self, baseline: Baseline, mutant: Mutant) -> tuple[float, ...]:
        kills, total = self.kills[mutant.file, baseline.file], self.total[baseline.file]
        return (-kills, -total, baseline.wall_s)

    def case(self, file: Path, mutant: Mutant | None = None, baseline: Baseline | None = None) -> Case:
        key = str(next(self.numbers))
        made = Case(key, file, self.folder / key, tier=self.tier, overrides=self.overrides)
        if mutant is None or baseline is None:
            return made
        limit_s = SLOWER * baseline.mission_s + GRACE_S
        return Case(
            key,
            file,
            self.folder / key,
            tier=self.tier,
            overrides=(*self.overrides, f"time_limit={limit_s:.0f} s"),
            instead=mutant.instead,
            wall_s=WALL_SLOWER * baseline.wall_s + WALL_GRACE_S,
        )
