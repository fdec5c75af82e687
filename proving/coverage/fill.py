"""Proposes scenarios for the holes of a suite: faults that should provoke what is missing, tried and kept."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from executive.run import ResolvedScenario
from executive.tree.strategies import load_strategies, usable_trees
from proving.coverage.excuses import Excuses
from proving.coverage.items import Item
from proving.coverage.search import Proposal, Search
from proving.coverage.universe import Universe
from proving.engine import run_cases
from proving.scenario_data import stripped, written
from proving.suite.collect import collect


@dataclass(frozen=True)
class Filled:
    """What came of it: proposals, what went wrong on the way, coverage of the suite alone and with them."""

    proposals: tuple[Proposal, ...]
    wrong: tuple[Proposal, ...]
    before: float
    after: float
    runs: int


def fill(
    paths: Sequence[Path],
    most: int,
    slots: int = 1,
    tier: str | None = None,
    excuses: Excuses | None = None,
    tell: Callable[[Proposal, float], None] = lambda proposal, ratio: None,
) -> Filled:
    """Look for scenarios that show what a suite does not, in at most `most` runs beside the suite's own.

    `tell` hears of each proposal, and the coverage with it. ConfigError for a bad suite.
    """
    suite = [each.scenario for each in collect(paths, tier=tier)]
    strategies = {strategy.name: strategy for strategy in load_strategies()}
    found: list[Proposal] = []
    before = 0.0
    with TemporaryDirectory(prefix="fill-") as folder:
        search = Search(Path(folder), _universe(suite), suite, excuses or Excuses(), strategies, most)
        for ending in run_cases(search, slots):
            proposal = search.hear(ending)
            ratio = search.coverage().share().ratio
            if proposal is not None:
                found.append(proposal)
                tell(proposal, ratio)
            elif search.ended <= len(suite):
                before = ratio
    kept = needed([proposal for proposal in found if not proposal.wrong])
    wrong = tuple(proposal for proposal in found if proposal.wrong)
    return Filled(kept, wrong, before, search.coverage().share().ratio, search.ended)


def needed(proposals: list[Proposal]) -> tuple[Proposal, ...]:
    """Without those whose every hole is filled by the others too, earlier ones first."""
    kept = list(proposals)
    for proposal in proposals:
        others = frozenset[Item]().union(*(other.shows for other in kept if other is not proposal))
        if set(proposal.fills) <= others:
            kept.remove(proposal)
    return tuple(kept)


def text(proposal: Proposal, name: str) -> str:
    """The scenario file of a proposal: what it shows stands above it, what was observed is expected."""
    shows = [f"{item.name}: {item.word}" for item in proposal.fills]
    doc = f"Went wrong: {proposal.wrong}" if proposal.wrong else f"Shows {'; '.join(shows[:3])}."
    data = proposal.data | {"scenario": name, "doc": doc, "expect": {"outcome": proposal.outcome}}
    head = "# Proposed by `longarm fill`: it expects what was observed. Is that what should happen?\n"
    lines = "".join(f"#   {line}\n" for line in shows)
    return f"{head}{'# It fills' + chr(10) + lines if lines else ''}{written(stripped(data))}"


def file_name(proposal: Proposal) -> str:
    """After the first hole that it fills, or after its going wrong and the fault that did it."""
    item = proposal.fills[0] if proposal.fills and not proposal.wrong else None
    last = proposal.data["faults"][-1]
    words = f"{item.name.replace('/', ' ')} {item.word}" if item else f"wrong {last['name']} {last['from']}"
    return re.sub(r"\W+", "_", words).strip("_").lower()[-80:].strip("_")


def _universe(suite: list[ResolvedScenario]) -> Universe:
    universe, answers = Universe(), usable_trees()
    for scenario in suite:
        universe.add(scenario.tree, answers)
    return universe
