"""Mutants that may live: the `equivalent_mutants` of a coverage file, held against what was found.

equivalent_mutants:
  - mutant: "navigate/selector/mission: swap dead_reckon and find_rover*"
    because: nothing reads the pose between the two
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from executive.config.find import shown
from executive.config.source import Mark, read
from executive.config.validate import guess, parse
from executive.core.errors import Problem
from proving.coverage.excuses import CoverageFile, EquivalentMutant
from proving.mutation.mutants import Mutant
from proving.mutation.trial import Found


@dataclass(frozen=True)
class Equivalents:
    """The entries of a file, each with its place."""

    entries: tuple[tuple[EquivalentMutant, Mark], ...] = ()

    def of(self, mutants: Iterable[Mutant]) -> dict[Mutant, str]:
        """Those that may live, with the reason."""
        return {m: e.because for m in mutants for e, _ in self.entries if fnmatchcase(m.name, e.mutant)}

    def problems(self, found: Iterable[Found], complete: bool) -> list[Problem]:
        """Entries about a mutant that was noticed; if all mutants were made, also those about none."""
        found = list(found)
        problems = []
        for entry, mark in self.entries:
            meant = [f for f in found if fnmatchcase(f.mutant.name, entry.mutant)]
            problems += [
                mark.problem(f'got "{f.mutant.name}", which {f.killer} notices ({f.why}); expected none to')
                for f in meant
                if f.killer is not None
            ]
            if complete and not meant:
                names = [f.mutant.name for f in found]
                text = f'got "{entry.mutant}", expected the name of a mutant{guess(entry.mutant, names)}'
                problems.append(mark.problem(text))
        return problems


def read_equivalents(path: Path) -> Equivalents:
    """ConfigError with every problem of the file."""
    source = read(path, shown(path))
    entries = parse(source, CoverageFile).equivalent_mutants
    return Equivalents(tuple((e, source.at(("equivalent_mutants", i))) for i, e in enumerate(entries)))
