"""A suite: the scenario files under some paths, and how the run of one is judged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.config.find import shown
from executive.config.source import read
from executive.errors import ConfigError, Problem
from executive.scenario import resolve_scenario
from proving.coverage.run import Ended

REACHED = "reached"
NO_VERDICT = ("invalid", "error")
IDENTITY = ("digest", "wall", "wall_s")
"""What differs between two runs that did the same, the scenario's own text apart."""


@dataclass(frozen=True)
class Verdict:
    """What a run came to. `held` are the expectations and safety rows that were met, by their texts."""

    passed: bool
    outcome: str
    held: frozenset[str]
    missed: tuple[str, ...]
    behaviour: dict[str, Any]

    def worse_than(self, before: Verdict) -> str | None:
        """The first thing that held before and does not now, None if there is none."""
        lost = [text for text in self.missed if text in before.held]
        lost += sorted(text for text in before.held - self.held - set(self.missed))
        if self.outcome in NO_VERDICT and before.outcome not in NO_VERDICT:
            return f"{self.outcome}: {self.behaviour.get('reason') or 'no result'}"
        if lost:
            return lost[0]
        return f"ended {self.outcome}" if before.passed and not self.passed else None


def verdict_of(ended: Ended) -> Verdict:
    """The verdict on a run that ended; one without a result is an error."""
    result = ended.result
    if result is None:
        return Verdict(False, "error", frozenset(), (), {"reason": f"{ended.cause}: {ended.detail}"})
    rows = [
        row for key in ("safety", "expectations") for row in result.get(key, ()) if row["met"] is not None
    ]
    missed = tuple(str(row["text"]) for row in rows if not row["met"])
    held = frozenset(str(row["text"]) for row in rows if row["met"])
    wanted = bool(result["expectations"]) or result["outcome"] == REACHED
    passed = wanted and not missed and result["outcome"] != "invalid"
    behaviour = {key: value for key, value in result.items() if key not in IDENTITY}
    return Verdict(passed, result["outcome"], held, missed, behaviour)


def scenario_files(paths: Sequence[Path]) -> list[Path]:
    """The scenario files among and under these paths, sorted within a folder.

    ConfigError with every problem of those that cannot be used; where there is none at all, that too.
    """
    problems: list[Problem] = []
    files = list(dict.fromkeys(file for path in paths for file in _under(path, problems)))
    for file in files:
        try:
            resolve_scenario(file)
        except ConfigError as error:
            problems.extend(error.problems)
    if not files and not problems:
        names = ", ".join(map(str, paths))
        problems.append(Problem(names, 1, 1, "got no scenario, expected a scenario file or a folder of some"))
    if problems:
        raise ConfigError(problems)
    return files


def _under(path: Path, problems: list[Problem]) -> Iterator[Path]:
    if not path.is_dir():
        yield path
        return
    for file in sorted((*path.rglob("*.yaml"), *path.rglob("*.yml"))):
        try:
            data = read(file, shown(file)).data
        except ConfigError as error:
            problems.extend(error.problems)
        else:
            if isinstance(data, dict) and "scenario" in data and "campaign" not in data:
                yield file
