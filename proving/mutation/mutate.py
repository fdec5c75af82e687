"""A mutation run: baselines first, then every mutant, many at once; and what came of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from executive.chance import generator
from executive.clock import Stopwatch
from executive.pool_plugins import load_strategies
from proving.coverage.suite import scenario_files
from proving.coverage.trials import conduct
from proving.mutation.equivalents import Equivalents
from proving.mutation.mutants import Forest, Mutant
from proving.mutation.trial import Baseline, Court, Found


@dataclass(frozen=True)
class MutationOptions:
    """What the command line may say. `only` are names of trees; `limit` draws so many mutants at random."""

    slots: int = 1
    tier: str | None = None
    overrides: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    limit: int | None = None
    seed: int = 0


@dataclass(frozen=True)
class Score:
    """What became of the mutants, in the order they were made; `equivalent` says why one may live."""

    baselines: tuple[Baseline, ...]
    found: tuple[Found, ...]
    equivalent: Mapping[Mutant, str]
    wall_s: float

    @property
    def killed(self) -> int:
        return sum(f.killer is not None for f in self.found)

    @property
    def survivors(self) -> list[Found]:
        return [f for f in self.found if f.killer is None and f.mutant not in self.equivalent]

    @property
    def ratio(self) -> float:
        counted = self.killed + len(self.survivors)
        return self.killed / counted if counted else 1.0

    @property
    def per_hour(self) -> float:
        return 3600.0 * len(self.found) / self.wall_s if self.wall_s else 0.0


def mutate(
    tree: Path | str,
    paths: Sequence[Path],
    options: MutationOptions,
    equivalents: Equivalents,
    tell: Callable[[Baseline | Found, int], None] = lambda news, total: None,
) -> Score:
    """Put every mutant of a tree, of the trees in it and of its strategies on trial before a suite.

    `tell` hears of each baseline and each mutant as it ends, with how many there are. ConfigError for a bad
    tree or scenario.
    """
    files = scenario_files(paths)
    forest = Forest.of(tree, load_strategies())
    mutants = chosen(forest, options)
    watch = Stopwatch()
    with TemporaryDirectory(prefix="mutants-") as folder:
        court = Court(Path(folder), options.tier, options.overrides, forest.universe)
        suite = []
        for baseline in conduct((court.baseline(file) for file in files), options.slots):
            suite.append(baseline)
            tell(baseline, len(files))
        suite.sort(key=lambda b: files.index(b.file))
        found = {}
        for one in conduct((court.trial(mutant, suite) for mutant in mutants), options.slots):
            found[one.mutant] = one
            tell(one, len(mutants))
    in_order = tuple(found[mutant] for mutant in mutants)
    return Score(tuple(suite), in_order, equivalents.of(mutants), watch.elapsed_s())


def chosen(forest: Forest, options: MutationOptions) -> list[Mutant]:
    """The mutants to try: of the trees asked for, so many at random if there is a limit."""
    mutants = list(forest.mutants(options.only))
    if options.limit is None or options.limit >= len(mutants):
        return mutants
    drawn = generator(options.seed, "mutants").choice(len(mutants), options.limit, replace=False)
    return [mutants[i] for i in sorted(drawn)]
