"""A mutation run: baselines first, then every mutant, many at once; and what came of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from executive.core.chance import generator
from executive.core.clock import Stopwatch
from executive.run.resolve import resolve_scenario
from executive.tree.strategies import load_strategies
from proving.coverage.trials import Trial, conduct
from proving.mutation.equivalents import Equivalents
from proving.mutation.mutants import Forest, Mutant
from proving.mutation.trial import Baseline, Court, Found
from proving.suite.collect import Collected, collect


@dataclass(frozen=True)
class MutationOptions:
    """What the command line may say. `only` are names of trees; `limit` draws so many mutants at random.

    To `believe` is not to try what is said to be equivalent.
    """

    slots: int = 1
    tier: str | None = None
    overrides: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    limit: int | None = None
    seed: int = 0
    believe: bool = False


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
    collected = [_as_run(each, options) for each in collect(paths)]
    forest = Forest.of(tree, load_strategies())
    mutants = chosen(forest, options)
    spared = equivalents.of(mutants)
    tried = [m for m in mutants if not (options.believe and m in spared)]
    watch = Stopwatch()
    with TemporaryDirectory(prefix="mutants-") as folder:
        court = Court(Path(folder), options.tier, options.overrides, forest.universe)
        docket = _Docket(court, collected, tried)
        for news in conduct(docket, options.slots):
            docket.hear(news)
            tell(news, len(collected) if isinstance(news, Baseline) else len(tried))
    found = tuple(docket.found.get(mutant, Found(mutant, None, "not tried", 0, False)) for mutant in mutants)
    return Score(docket.suite, found, spared, watch.elapsed_s())


class _Docket(Iterator[Trial[Baseline | Found]]):
    """What is tried next: the tree as it is in every scenario, and when all of that is known, the mutants."""

    def __init__(self, court: Court, collected: Sequence[Collected], mutants: Sequence[Mutant]) -> None:
        self.court, self.collected = court, collected
        self.baselines, self.mutants = iter(collected), iter(mutants)
        self.heard: dict[Path, Baseline] = {}
        self.found: dict[Mutant, Found] = {}

    @property
    def suite(self) -> tuple[Baseline, ...]:
        """The baselines in the order of the suite."""
        return tuple(self.heard[each.file] for each in self.collected)

    def __next__(self) -> Trial[Baseline | Found]:
        for each in self.baselines:
            return self.court.baseline(each)
        if len(self.heard) < len(self.collected):
            raise StopIteration  # for now
        return self.court.trial(next(self.mutants), self.suite)

    def hear(self, news: Baseline | Found) -> None:
        if isinstance(news, Baseline):
            self.heard[news.file] = news
        else:
            self.found[news.mutant] = news


def _as_run(collected: Collected, options: MutationOptions) -> Collected:
    """With the tier and the values that the options replace; ConfigError where they do not fit."""
    scenario = resolve_scenario(collected.file, None, options.tier, options.overrides)
    return replace(collected, scenario=scenario)


def chosen(forest: Forest, options: MutationOptions) -> list[Mutant]:
    """The mutants to try: of the trees asked for, so many at random if there is a limit."""
    mutants = list(forest.mutants(options.only))
    if options.limit is None or options.limit >= len(mutants):
        return mutants
    drawn = generator(options.seed, "mutants").choice(len(mutants), options.limit, replace=False)
    return [mutants[i] for i in sorted(drawn)]
