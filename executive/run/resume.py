"""`longarm run --resume`: go on with a run that was killed, from its own folder.

The world is brought back by running the kept scenario again from its seed. All that is recorded on the way
must be, bit for bit, what was recorded before; where that ends the run goes on (docs/decisions/0050).
"""

from __future__ import annotations

from pathlib import Path

from executive.core.clock import Stopwatch
from executive.core.errors import ConfigError, Problem, RecordError
from executive.core.interrupts import Interrupted
from executive.core.registry import in_project
from executive.record import RunFigures, read_result
from executive.record.continuation import Continuation, Diverged, beside
from executive.record.integrity import SUMS
from executive.record.reader import is_complete
from executive.record.run_folder import locked
from executive.run import app
from executive.run.judging import exit_code, judged
from executive.run.kept_files import changes, damaged
from executive.run.recording import RECORD, TRUTH, continued
from executive.run.resolve import resolve_scenario
from executive.run.resolved import ResolvedScenario
from executive.run.runner import RunEnd
from executive.tree.strategies import load_strategies

RESULT = "result.json"


def resume(folder: Path, bar: bool = True, as_begun: bool = False) -> app.Finished:
    """Go on with the run in `folder`; of one that has ended, its result.

    ConfigError for a folder that is no run's, or where a file that the run used has changed since: `as_begun`
    goes on with the copies that the folder keeps. Diverged where the world does not come back as it was;
    the folder is then as it was before.
    """
    for name in ("scenario.yaml", RECORD):
        if not (folder / name).is_file():
            raise RecordError(f"{folder}: got no {name}, expected the folder of a run that had begun")
    with locked(folder):
        if has_ended(folder):
            return _ended(folder)
        refuse_changed(folder, as_begun)
        scenario = resolve_scenario(folder / "scenario.yaml")
        with in_project(scenario.project):
            return _resumed(scenario, folder, bar)


def has_ended(folder: Path) -> bool:
    """Whether a run has come to its end, and has written what it came to."""
    return is_complete(folder / RECORD) and all((folder / name).is_file() for name in (RESULT, SUMS))


def refuse_changed(folder: Path, as_begun: bool) -> None:
    """ConfigError where the run would go on with other files than it began with, all of them named."""
    found = [*damaged(folder), *changes(folder, but_copied=as_begun)]
    if found:
        advice = "" if as_begun else "; --as-begun goes on with the copies that the run folder keeps"
        expected = f"expected the files that the run began with{advice}"
        raise ConfigError(
            [Problem(str(folder), 1, 1, f"got a change in {what}, {expected}") for what in found]
        )


def _ended(folder: Path) -> app.Finished:
    scenario = resolve_scenario(folder / "scenario.yaml")
    with in_project(scenario.project):
        if not (folder / "report.html").is_file():
            app.report(folder)
        result = read_result(folder / RESULT)
        _, met = judged(scenario, folder, RunFigures())
    return app.Finished(folder, result, exit_code(result.outcome, met))


def _resumed(scenario: ResolvedScenario, folder: Path, bar: bool) -> app.Finished:
    scenario.localizer.spec.prepare(app.teller(bar))
    watch, text = Stopwatch(), (folder / "scenario.yaml").read_text()
    recording = continued(folder)
    try:
        end = app.record_run(scenario, load_strategies(), text, watch, recording, bar)
    finally:
        if not recording.recorder.behind:
            recording.settle()
        for name in (RECORD, TRUTH):
            beside(folder / name).unlink(missing_ok=True)
    if recording.recorder.behind:
        raise _not_brought_back(folder, recording.recorder, end)
    return app.conclude(scenario, folder, end, watch, with_report=True)


def _not_brought_back(folder: Path, recorder: Continuation, end: RunEnd) -> BaseException:
    """Why a run ended before all was recorded again that had been recorded."""
    if end.signal is not None:
        return Interrupted(end.signal)
    if recorder.divergence is not None:
        return Diverged(f"{folder}: the run does not come back as it was: {recorder.divergence}")
    return end.defect or RecordError(f"{folder}: the run ended earlier than it had: {end.reason}")
