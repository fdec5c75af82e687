"""Runs collected scenarios, each in a child of its own, and judges them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from executive.record import RunResult
from proving.engine import Case, Ending, Limits, run_cases, settle
from proving.judge.verdict import Terms, Verdict, judged, repeat_command
from proving.suite.collect import Collected


@dataclass(frozen=True)
class Tested:
    """A scenario that has been run."""

    collected: Collected
    verdict: Verdict
    ending: Ending
    result: RunResult
    repeat: str

    @property
    def folder(self) -> Path:
        return self.ending.case.folder

    def to_json(self) -> dict[str, object]:
        """One row of `longarm test --json`."""
        return {
            "file": str(self.collected.file),
            "scenario": self.collected.scenario.name,
            "seed": self.collected.scenario.seed,
            "verdict": str(self.verdict.word),
            "message": self.verdict.message,
            "class": str(self.ending.kind),
            "outcome": self.result.outcome,
            "wall_s": round(self.ending.wall_s, 3),
            "repeat": self.repeat,
            "folder": str(self.folder),
        }


@dataclass(frozen=True)
class SuiteOptions:
    """How a suite is run."""

    out: Path
    slots: int = 1
    seed: int | None = None
    tier: str | None = None
    limits: Limits = Limits()  # noqa: RUF009  (frozen)


def case_of(collected: Collected, options: SuiteOptions) -> Case:
    """The case that runs a scenario file as it stands."""
    return Case(
        key=collected.name,
        file=collected.file.absolute(),
        folder=(options.out / collected.name).absolute(),
        seed=options.seed,
        tier=options.tier,
        limits=options.limits,
    )


def run_suite(
    collected: Iterable[Collected],
    options: SuiteOptions,
    begun: Callable[[Case], None] = lambda case: None,
) -> Iterator[Tested]:
    """Each scenario, judged, in the order in which they end."""
    by_key = {each.name: each for each in collected}
    cases = (case_of(each, options) for each in by_key.values())
    for ending in run_cases(cases, options.slots, begun):
        yield tested(by_key[ending.case.key], ending)


def tested(collected: Collected, ending: Ending) -> Tested:
    """The verdict on one scenario."""
    result = settle(ending)
    verdict = judged(ending, result, Terms.of(collected.scenario))
    case = ending.case
    shown = Case(case.key, collected.file, case.folder, seed=case.seed, tier=case.tier)
    return Tested(collected, verdict, ending, result, repeat_command(shown, collected.scenario.seed))
