"""A failing run or scenario → the smallest scenario found that still fails in the same way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import yaml

from executive.record import read_result, require_sound
from executive.report.figure import counted
from executive.run.resolve import resolve_scenario
from proving.engine.server import ForkServer
from proving.minimise.failure import Failure, signed
from proving.minimise.reductions import reduce_all
from proving.minimise.trier import Trier
from proving.scenario_data import Data, stripped, written

MOST_RUNS = 200


@dataclass(frozen=True)
class Minimised:
    """What came of it; `failure` None: the case does not fail, and nothing was tried."""

    failure: Failure | None
    weaker: tuple[str, ...]
    """In what the smaller case fails otherwise than it did, or than its record says."""
    before: Data
    after: Data
    runs: int
    steps: tuple[str, ...]
    exhausted: bool
    """Whether the runs were used up before nothing could be made smaller."""

    def text(self, source: Path) -> str:
        """The file: says what it is, then the scenario."""
        sizes = ", ".join(f"{before} {noun} → {after}" for noun, before, after in self.sizes())
        head = f"# Minimised from {source.name} in {counted(self.runs, 'run')}: {sizes}.\n"
        weaker = f" (otherwise than before: {'; '.join(self.weaker)})" if self.weaker else ""
        return f"{head}# It fails with {self.failure}{weaker}\n{written(self.after)}"

    def sizes(self) -> list[tuple[str, int, int]]:
        """What there was and what is left, by kind."""
        return [
            ("faults", len(self.before.get("faults", ())), len(self.after.get("faults", ()))),
            (
                "way-points",
                len(self.before["mission"]["waypoints"]),
                len(self.after["mission"]["waypoints"]),
            ),
        ]


def minimise(
    source: Path,
    seed: int | None = None,
    tier: str | None = None,
    most: int = MOST_RUNS,
    tell: Callable[[str], None] = lambda step: None,
    loosely: bool = False,
) -> Minimised:
    """Minimise a scenario file, or the scenario of a run folder.

    The whole signature of the failure stays, or `loosely` only what is violated first.

    Deterministic; no scenario is run twice, and none after `most` runs. ConfigError for bad input.
    """
    require_sound(source / "record.mcap")
    file = source / "scenario.yaml" if source.is_dir() else source
    before: Data = yaml.safe_load(resolve_scenario(file, seed, tier).dump())
    with TemporaryDirectory(prefix="minimise-") as folder, ForkServer() as server:
        trier = Trier(
            server,
            Path(folder),
            most,
            lambda step: tell(f"[{trier.runs}/{most} runs] {step}"),
            loosely=loosely,
        )
        failure = trier.begin(before)
        if failure is not None:
            reduce_all(trier)
    after = trier.best if failure is None else stripped(trier.best)
    weaker = _weaker(failure, trier.found, source)
    return Minimised(failure, weaker, before, after, trier.runs, tuple(trier.steps), trier.exhausted)


def _weaker(failure: Failure | None, found: Failure | None, source: Path) -> tuple[str, ...]:
    """In what the smallest case fails otherwise than the one that was given; a run folder says how it did."""
    if failure is None or found is None:
        return ()
    result = source / "result.json"
    given = signed(failure, read_result(result)) if result.is_file() else failure
    return tuple(given.differences(found))
