"""Named reasons for holes: a file that says what cannot happen, and why; held against what did happen.

    coverage: shipped
    cannot_happen:
      - node: "*/take_picture"
        outcomes: [device]
        because: the simulated cameras never refuse a picture
      - {hypothesis: tilt_risk, because: no scenario is steep enough to tilt the rover}

Names may have `*`. Without `outcomes`, all of them are meant.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from executive.config.file_kinds import FileKind
from executive.config.find import shown
from executive.config.source import Mark, Source, read
from executive.config.validate import Strict, guess, listed, parse
from executive.core.errors import Problem
from proving.coverage.items import KINDS, Item
from proving.coverage.seen import Seen

Word = Annotated[str, Field(min_length=1)]


class Excuse(Strict):
    """What cannot happen, and why."""

    node: Word | None = None
    strategy: Word | None = None
    phase: Word | None = None
    fault: Word | None = None
    hypothesis: Word | None = None
    outcomes: tuple[Word, ...] = ()
    because: Annotated[str, Field(min_length=10)]

    @model_validator(mode="after")
    def one_of_them(self) -> Self:
        named = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(named) != 1:
            got = " and ".join(named) if named else "none"
            text = f"got {got}, expected exactly one of {listed(KINDS)}"
            raise PydanticCustomError("located", "{text}", {"text": text})
        return self

    @property
    def kind(self) -> str:
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    def matches(self, item: Item) -> bool:
        pattern = str(getattr(self, self.kind))
        if item.kind != self.kind or not fnmatchcase(item.name, pattern):
            return False
        return not self.outcomes or item.word in self.outcomes


class EquivalentMutant(Strict):
    """Mutants, by a pattern of their names, that no scenario can tell from the original, and why."""

    mutant: Word
    because: Annotated[str, Field(min_length=10)]


class CoverageFile(Strict):
    """The file: what coverage shall not ask for, and what mutation shall not."""

    coverage: Word
    doc: str = ""
    cannot_happen: tuple[Excuse, ...] = ()
    equivalent_mutants: tuple[EquivalentMutant, ...] = ()


@dataclass(frozen=True)
class Excuses:
    """The excuses of a file, each with its place."""

    entries: tuple[tuple[Excuse, Mark], ...] = ()

    def of(self, items: Iterable[Item]) -> dict[Item, str]:
        """The items that are excused, with the reason."""
        return {item: excuse.because for item in items for excuse, _ in self.entries if excuse.matches(item)}

    def problems(self, items: Iterable[Item], seen: Seen) -> list[Problem]:
        """Excuses that are about nothing (any more), and excuses for what did happen."""
        items = tuple(items)
        return [problem for entry in self.entries for problem in _problems(*entry, items, seen)]


def read_excuses(path: Path) -> Excuses:
    """The file's excuses; ConfigError with every problem in it."""
    return excuses_in(read(path, shown(path)))


def excuses_in(source: Source) -> Excuses:
    """The same from a file already read."""
    file = parse(source, CoverageFile)
    return Excuses(
        tuple((entry, source.at(("cannot_happen", i))) for i, entry in enumerate(file.cannot_happen))
    )


def _problems(excuse: Excuse, mark: Mark, items: tuple[Item, ...], seen: Seen) -> Iterable[Problem]:
    meant = [item for item in items if excuse.matches(item)]
    for word in excuse.outcomes or (None,):
        if not any(word in (None, item.word) for item in meant):
            yield mark.problem(_about_nothing(excuse, word, items))
    for item in meant:
        if item in seen.count:
            yield mark.problem(f"got {item}, which happened in {seen.first[item]}; expected a hole")


def _about_nothing(excuse: Excuse, word: str | None, items: tuple[Item, ...]) -> str:
    name = str(getattr(excuse, excuse.kind))
    same = {item.name for item in items if item.kind == excuse.kind}
    if any(fnmatchcase(known, name) for known in same):
        words = sorted({i.word for i in items if i.kind == excuse.kind and fnmatchcase(i.name, name)})
        return f'got the outcome "{word}" of {name}, expected {listed(words)}{guess(word, words)}'
    return f'got the {excuse.kind} "{name}", expected one that the runs could show{guess(name, same)}'


KIND = FileKind("coverage", excuses_in, CoverageFile.model_json_schema)
