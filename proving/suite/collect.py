"""Which files are scenarios, each resolved before anything runs."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from executive.config.find import find, shown
from executive.config.source import Mark, read
from executive.config.validate import Problems
from executive.core.errors import ConfigError
from executive.run import ResolvedScenario
from executive.run.resolve import resolve_source

SUFFIXES = (".yaml", ".yml")
_TOP_LEVEL_SCENARIO = re.compile(r"^scenario\s*:", re.M)


@dataclass(frozen=True)
class Collected:
    """A scenario file, and what it resolves to."""

    file: Path
    scenario: ResolvedScenario

    @property
    def name(self) -> str:
        """Names the file among all others: its path without suffix, seen from the working folder."""
        return str(Path(shown(self.file.absolute())).with_suffix("")).strip("/")


def collect(paths: Iterable[Path], seed: int | None = None, tier: str | None = None) -> list[Collected]:
    """The scenarios named, and those in folders named (at any depth), in order, each once.

    ConfigError with the problems of all of them.
    """
    problems = Problems()
    found: dict[Path, Collected | None] = {}
    for number, path in enumerate(paths, 1):
        mark = Mark("PATH", number, 1)
        for file in problems.attempt(_files, path, mark) or ():
            if file.resolve() not in found:
                found[file.resolve()] = problems.attempt(one, file, seed, tier)
    problems.check()
    return [each for each in found.values() if each is not None]


def one(file: Path, seed: int | None = None, tier: str | None = None) -> Collected:
    """One scenario file; ConfigError if it is none or has problems."""
    source = read(file, shown(file.absolute()))
    if isinstance(source.data, dict) and "scenario" not in source.data:
        raise ConfigError([source.at(()).problem('got no "scenario", expected a scenario file')])
    return Collected(file, resolve_source(source, seed, tier))


def says_scenario(file: Path) -> bool:
    """Whether the file looks like a scenario, told without understanding the rest of it."""
    try:
        return file.suffix in SUFFIXES and bool(_TOP_LEVEL_SCENARIO.search(file.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError):
        return False


def _files(path: Path, mark: Mark) -> list[Path]:
    if path.is_dir():
        files = [file for file in sorted(path.rglob("*")) if says_scenario(file)]
        if not files:
            raise ConfigError([mark.problem(f'got "{path}", expected a folder with scenario files in it')])
        return files
    return [path if path.is_file() else Path(shown(find("scenarios", str(path), Path(), mark)))]
