"""Coverage put together: what there is, what was shown, what is excused, what is missing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from executive.core.errors import Problem
from proving.coverage.excuses import Excuses, read_excuses
from proving.coverage.items import KINDS, Item
from proving.coverage.seen import Seen, read_runs
from proving.coverage.universe import Universe


@dataclass(frozen=True)
class Share:
    """How many of a kind were covered, of those that are not excused."""

    covered: int
    of: int
    excused: int

    @property
    def ratio(self) -> float:
        return self.covered / self.of if self.of else 1.0


@dataclass(frozen=True)
class Coverage:
    """The coverage of some runs."""

    universe: Universe
    seen: Seen
    items: tuple[Item, ...]
    excused: dict[Item, str]
    problems: tuple[Problem, ...]
    """Of the excuses: about nothing, or for something that did happen."""

    def covers(self, item: Item) -> bool:
        return item in self.seen.count

    def holes(self, kind: str | None = None) -> list[Item]:
        """What was neither shown nor excused."""
        return [
            i for i in self.items if kind in (None, i.kind) and not self.covers(i) and i not in self.excused
        ]

    def share(self, kind: str | None = None) -> Share:
        """Of one kind, or of all. What is excused does not count, unless it happened after all."""
        mine = [item for item in self.items if kind in (None, item.kind)]
        covered = sum(map(self.covers, mine))
        excused = sum(item in self.excused and not self.covers(item) for item in mine)
        return Share(covered, len(mine) - excused, excused)

    def shares(self) -> dict[str, Share]:
        return {kind: self.share(kind) for kind in KINDS}


def cover(folders: list[Path], excuses: Path | None = None) -> Coverage:
    """The coverage of all runs in these folders.

    ConfigError for a bad file of excuses, RecordError for a folder without runs.
    """
    given = read_excuses(excuses) if excuses else Excuses()
    universe, seen = read_runs(folders)
    return put_together(universe, seen, given)


def put_together(universe: Universe, seen: Seen, excuses: Excuses) -> Coverage:
    """Coverage of what was seen so far."""
    items = universe.items()
    problems = excuses.problems(items, seen)
    return Coverage(universe, seen, items, excuses.of(items), tuple(sorted(set(problems))))
