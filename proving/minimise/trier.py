"""Tries smaller cases: each resolved first, run once at most, and kept if it fails as the original does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from shutil import rmtree

from executive.core.errors import ConfigError
from executive.record import RunResult
from executive.run import ResolvedScenario
from proving.engine import Case, Limits, settle
from proving.engine.server import ForkServer
from proving.engine.supervisor import run_alone
from proving.minimise.failure import Failure, failure_of
from proving.scenario_data import Data, resolved, written

WALL_SLOWER, WALL_GRACE_S = 10.0, 60.0


@dataclass
class Trier:
    """`best` is the smallest case so far that fails with `wanted`, `result` its result.

    After `most` runs nothing is tried any more. `tell` hears of each step that was kept. `loosely`: the same
    is violated first, whatever else of the failure changes.
    """

    server: ForkServer
    folder: Path
    most: int
    tell: Callable[[str], None]
    best: Data = field(default_factory=dict)
    result: RunResult = RunResult()  # noqa: RUF009  (frozen)
    wanted: Failure | None = None
    loosely: bool = False
    found: Failure | None = None
    """How the best case fails."""
    limits: Limits = field(default_factory=Limits)
    runs: int = 0
    known: dict[str, bool] = field(default_factory=dict)
    """Whether a resolved scenario fails as wanted; `tried` says the same by the texts of files."""
    tried: dict[str, bool] = field(default_factory=dict)
    steps: list[str] = field(default_factory=list)

    def begin(self, data: Data) -> Failure | None:
        """Run the case as it is; how it fails, None if it does not. ConfigError where it cannot be run."""
        scenario = resolved(data)
        self.wanted, self.result, wall_s = self._run(data, scenario)
        self.limits = Limits(wall_s=WALL_SLOWER * wall_s + WALL_GRACE_S)
        self.known[scenario.dump()] = True
        self.best, self.found = data, self.wanted
        return self.wanted

    def keeps(self, data: Data, what: str) -> bool:
        """Whether a smaller case fails in the same way; then it is the best from now on."""
        text = written(data)
        if text not in self.tried:
            if self.exhausted:
                return False
            self.tried[text] = self._fails(data)
        if self.tried[text] and data != self.best:
            self.best = data
            self.steps.append(what)
            self.tell(what)
        return self.tried[text]

    @property
    def exhausted(self) -> bool:
        return self.runs >= self.most

    def _fails(self, data: Data) -> bool:
        """Whether it fails as wanted; what comes to the same scenario as one known is not run again."""
        try:
            scenario = resolved(data)
        except ConfigError:
            return False
        same = scenario.dump()
        if same not in self.known:
            failure, result, _ = self._run(data, scenario)
            self.known[same] = failure is not None and failure.is_as(self.wanted, self.loosely)
            if self.known[same]:
                self.result, self.found = result, failure
        return self.known[same]

    def _run(self, data: Data, scenario: ResolvedScenario) -> tuple[Failure | None, RunResult, float]:
        self.runs += 1
        file, folder = self.folder / "case.yaml", self.folder / "run"
        file.write_text(written(data))
        ending = run_alone(self.server, Case("case", file, folder, limits=self.limits))
        result = settle(ending)
        rmtree(folder, ignore_errors=True)
        return failure_of(ending, result, scenario), result, ending.wall_s
