"""What the commands do: put a run together, run it, and leave a complete run folder behind."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from executive.config.backends import BackendRequest
from executive.config.reporter import REPORTER_KIND
from executive.core import registry
from executive.core.clock import Stopwatch
from executive.core.errors import LongarmError, RecordError
from executive.core.files import write_whole
from executive.core.interrupts import held_back
from executive.core.one_thread import one_thread
from executive.core.registry import in_project
from executive.pool import Strategy
from executive.record import History, RunResult, events, read_result, write_result
from executive.record.integrity import RECORDS, require_sound, write_sums
from executive.record.recorder import Recorder
from executive.record.result import RunFigures
from executive.record.run_folder import (
    RUN_FILES,
    free_folder,
    locked,
    make_folder,
    refuse_used,
    unwrite,
    write_traceback,
)
from executive.report import write_report
from executive.report.show import draw
from executive.run.assembly import TICK_S, set_up, write_start
from executive.run.judging import exit_code, judged
from executive.run.kept_files import keep_files
from executive.run.progress import progress_bar
from executive.run.recording import Recording, fresh
from executive.run.resolve import resolve_scenario
from executive.run.resolved import ResolvedScenario
from executive.run.runner import RunEnd, ended_by, execute, interrupted
from executive.tree.strategies import load_strategies, usable_trees


@dataclass(frozen=True)
class RunOptions:
    """What the command line may say about a run."""

    seed: int | None = None
    out: Path | None = None
    tier: str | None = None
    overrides: Sequence[str] = ()
    bar: bool = True
    force: bool = True
    """Whether a folder that holds a run already is written over."""
    alone: bool = False
    """Whether the folder is refused while another process writes a run into it."""
    report: bool = True
    """Whether `report.html` is written; `longarm report` can do it later."""
    cut_ticks: tuple[int, ...] = ()
    """Where the run that this one repeats was cut off and went on."""


@dataclass(frozen=True)
class Finished:
    """A run that ended: its folder, its result, and the exit code that stands for it."""

    folder: Path
    result: RunResult
    exit_code: int
    defect: BaseException | None = None


def run(file: Path, options: RunOptions) -> Finished:
    """Run a scenario or mission file. What a user can mend leaves nothing behind that was not there.

    A defect ends the run, not the folder: record, result and report are complete and `traceback.txt` tells.
    """
    return run_scenario(resolve_scenario(file, options.seed, options.tier, options.overrides), options)


def run_scenario(scenario: ResolvedScenario, options: RunOptions) -> Finished:
    """The same for a scenario already resolved; of the options, those that change it are without effect."""
    with in_project(scenario.project):
        return _run(scenario, options)


def _run(scenario: ResolvedScenario, options: RunOptions) -> Finished:
    strategies = load_strategies()
    scenario.localizer.spec.prepare(teller(options.bar))
    watch = Stopwatch()
    folder = options.out or free_folder(Path("runs"), f"{scenario.name}-{scenario.seed}")
    made = not folder.exists()
    make_folder(folder)
    try:
        with locked(folder) if options.alone else nullcontext():
            if not options.force:
                refuse_used(folder)
            return _written(scenario, strategies, folder, watch, options)
    finally:
        if made and not any(folder.iterdir()):
            folder.rmdir()


def _written(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    folder: Path,
    watch: Stopwatch,
    options: RunOptions,
) -> Finished:
    """The run, written into a folder that is this process's own."""
    for stale in RUN_FILES:
        (folder / stale).unlink(missing_ok=True)
    text = keep_files(scenario, folder)
    write_whole(folder / "scenario.yaml", text)  # first, so that a run cut off can be repeated
    try:
        end = record_run(scenario, strategies, text, watch, fresh(folder, options.cut_ticks), options.bar)
    except LongarmError:
        unwrite(folder)  # what a user can mend leaves nothing half-written behind
        raise
    return conclude(scenario, folder, end, watch, options.report)


def conclude(
    scenario: ResolvedScenario, folder: Path, end: RunEnd, watch: Stopwatch, with_report: bool
) -> Finished:
    """Judge a run that has ended, and write its result.

    One whose record could not be ended has none, as when the disk is full: what ended it is raised.
    """
    if isinstance(end.defect, OSError) and History.of(folder / "record.mcap").last(events.Stop) is None:
        raise end.defect
    if end.defect is not None:
        write_traceback(folder, end.defect)
    try:
        with held_back():
            return _conclude(scenario, folder, end, watch, with_report)
    except Exception as defect:
        write_traceback(folder, defect)
        raise


def teller(bar: bool) -> Callable[[str], None]:
    """Where lines for whoever looks on go: nowhere, if nobody does."""
    return partial(print, file=sys.stderr, flush=True) if bar else lambda line: None


def report(folder: Path) -> Path:
    """(Re)write the report of a run or campaign folder from its record; RecordError where there is none."""
    for name in registry.names(REPORTER_KIND):
        if (folder / f"{name}.json").is_file():
            return registry.get(REPORTER_KIND, name).write(folder)
    if not (folder / "record.mcap").is_file():
        raise RecordError(f"{folder}: got no record.mcap, expected a run or campaign folder")
    for name in RECORDS:
        require_sound(folder / name)
    return write_report(folder, _tree_svg(folder))


def record_run(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    text: str,
    watch: Stopwatch,
    recording: Recording[Recorder],
    bar: bool,
) -> RunEnd:
    """Execute a run and record it; `text` is the scenario as its folder has it."""
    route = scenario.mission.route()
    request = BackendRequest(
        world=scenario.world,
        route=route,
        seed=scenario.seed,
        tier=scenario.tier,
        rig=scenario.rig,
        truth_path=recording.truth_path,
        tick_s=TICK_S,
    )
    with one_thread(), recording.recorder as recorder:
        try:
            write_start(recorder, scenario, text)
            with progress_bar(scenario.name, route, bar) as listeners:
                prepared = set_up(scenario, strategies, request, recorder, watch, listeners, recording.cuts)
                end = execute(prepared)
        except LongarmError:
            raise
        except (Exception, KeyboardInterrupt) as early:  # a plug-in that cannot even be made; a signal
            end = interrupted(early) if isinstance(early, KeyboardInterrupt) else ended_by(early)
            recorder.write(events.Stop(end.outcome, end.reason), 0.0)
            return end
    for part, spent in prepared.backend.wall_s().items():
        watch.spent_s[part] += spent
    return end


def _conclude(
    scenario: ResolvedScenario, folder: Path, end: RunEnd, watch: Stopwatch, with_report: bool
) -> Finished:
    figures = RunFigures(
        wall_s=round(watch.elapsed_s(), 3),
        wall={part: round(spent, 3) for part, spent in sorted(watch.spent_s.items())},
        waypoints_total=len(scenario.mission.waypoints),
    )
    result, met = judged(scenario, folder, figures)
    write_result(folder / "result.json", result)
    write_sums(folder)
    if with_report:
        write_report(folder, _tree_svg(folder))
    asked = None if end.defect is not None else end.signal
    code = exit_code(result.outcome, met) if asked is None else 128 + asked
    return Finished(folder, read_result(folder / "result.json"), code, end.defect)


def _tree_svg(folder: Path) -> str | None:
    """The run's tree with its outcomes; None where the scenario no longer resolves."""
    try:
        drawing = draw_run(folder, "svg")
    except LongarmError:
        return None
    return drawing if isinstance(drawing, str) else None


def draw_run(folder: Path, form: str) -> str | bytes:
    """A run's tree in one of the drawing formats, coloured by how each node last ended."""
    if not (folder / "scenario.yaml").is_file():
        raise RecordError(f"{folder}: got no scenario.yaml, expected a run folder")
    scenario = resolve_scenario(folder / "scenario.yaml")
    with in_project(scenario.project):
        return draw(scenario.tree, form, usable_trees(), last_outcomes(folder))


def last_outcomes(folder: Path) -> dict[str, str]:
    """The status with which each node last ended, by path."""
    changes = History.of(folder / "record.mcap").all(events.NodeChange)
    return {at.event.path: at.event.status for at in changes if at.event.status != "invalid"}
