"""What the commands do: put a run together, run it, and leave a complete run folder behind."""

from __future__ import annotations

import json
import math
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from executive import plugins
from executive.backends import BackendRequest
from executive.classification import Classification
from executive.clock import Stopwatch
from executive.errors import ConfigError, LongarmError, PluginError, Problem, RecordError
from executive.expectations import judge
from executive.fault_schedule import FaultSchedule
from executive.journal import RunJournal
from executive.nodes.services import Services
from executive.pool import Pool, Strategy
from executive.ports import Backend, Devices, Localizer
from executive.prediction import quat_from_heading_tilt
from executive.progress import progress_bar
from executive.report import write_report
from executive.runner import Run, RunEnd, ended_by, execute
from executive.scenario import ResolvedScenario, resolve_scenario
from executive.show import draw
from executive.telemetry import History, events
from executive.telemetry.recorder import Recorder
from executive.telemetry.result import RunFigures, summarise, write_result
from executive.telemetry.versions import versions
from executive.tree.build import build
from executive.tree.load import load_tree
from executive.tree.spec import TreeSpec
from executive.types import PoseEstimate, Segment, Source

TICK_S = 1.0
REACHED, OTHERWISE, DEFECT = 0, 1, 3
RUN_FILES = (
    *("scenario.yaml", "record.mcap", "truth.mcap"),
    *("result.json", "report.html", "traceback.txt"),
)


@dataclass(frozen=True)
class RunOptions:
    """What the command line may say about a run."""

    seed: int | None = None
    out: Path | None = None
    tier: str | None = None
    overrides: Sequence[str] = ()
    bar: bool = True


@dataclass(frozen=True)
class Finished:
    """A run that ended: its folder, its result, and the exit code that stands for it."""

    folder: Path
    result: dict[str, Any]
    exit_code: int


def run(file: Path, options: RunOptions) -> Finished:
    """Run a scenario or mission file. What a user can mend leaves nothing behind that was not there.

    A defect ends the run, not the folder: record, result and report are complete and `traceback.txt` tells.
    """
    scenario = resolve_scenario(file, options.seed, options.tier, options.overrides)
    strategies = load_strategies()
    localizer = plugins.load(plugins.LOCALIZERS, scenario.file.localizer)
    watch = Stopwatch()
    folder = options.out or _free_folder(Path("runs"), f"{scenario.name}-{scenario.seed}")
    made = not folder.exists()
    _make_folder(folder)
    for stale in RUN_FILES:
        (folder / stale).unlink(missing_ok=True)
    (folder / "scenario.yaml").write_text(scenario.dump())  # first, so that a run cut off can be repeated
    try:
        end = _execute(scenario, strategies, localizer, folder, watch, options.bar)
    except LongarmError:
        _unwrite(folder, made)  # what a user can mend leaves nothing half-written behind
        raise
    if end.defect is not None:
        _write_traceback(folder, end.defect)
    try:
        return _conclude(scenario, folder, end, watch)
    except Exception as defect:
        _write_traceback(folder, defect)
        raise


def report(folder: Path) -> Path:
    """(Re)write the report of a run folder from its record; RecordError where there is none."""
    if not (folder / "record.mcap").is_file():
        raise RecordError(f"{folder}: got no record.mcap, expected a run folder")
    return write_report(folder, _tree_svg(folder))


def load_strategies() -> tuple[Strategy, ...]:
    """Every strategy registered, by name; PluginError for one that is not a `Strategy`."""
    loaded = []
    for name in plugins.found(plugins.STRATEGIES):
        strategy = plugins.load(plugins.STRATEGIES, name, Strategy)
        if isinstance(strategy, Strategy):
            loaded.append(strategy)
    return tuple(loaded)


def prior_pose(first: Segment) -> PoseEstimate:
    """What ground knows before the first fix: the rover stands near the first way-point, heading outward."""
    heading = math.atan2(first.start.y_m, first.start.x_m)
    return PoseEstimate(
        time_s=0.0,
        position_site_m=(first.start.x_m, first.start.y_m, 0.0),
        quat_site_body=quat_from_heading_tilt(heading, 0.0, 0.0),
        covariance=np.diag([0.05**2, 0.05**2, 0.20**2, 0.1**2, 0.1**2, 0.6**2]),
        source=Source.PRIOR,
    )


def _execute(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    localizer: object,
    folder: Path,
    watch: Stopwatch,
    bar: bool,
) -> RunEnd:
    route = scenario.mission.route()
    request = BackendRequest(
        world=scenario.world,
        route=route,
        seed=scenario.seed,
        tier=scenario.tier,
        rig=scenario.rig,
        truth_path=folder / "truth.mcap",
        tick_s=TICK_S,
    )
    with Recorder(folder / "record.mcap") as recorder:
        _write_start(recorder, scenario)
        try:
            prepared = _set_up(scenario, strategies, localizer, request, recorder, watch)
        except LongarmError:
            raise
        except Exception as defect:  # a plug-in that cannot even be made
            end = ended_by(defect)
            recorder.write(events.Stop(end.outcome, end.reason), 0.0)
            return end
        with progress_bar(scenario.name, sum(s.length_m for s in route), bar) as progress:
            prepared.progress = progress
            end = execute(prepared)
    for part, spent in prepared.backend.wall_s().items():
        watch.spent_s[part] += spent
    return end


def _write_start(recorder: Recorder, scenario: ResolvedScenario) -> None:
    start = events.Start(scenario.name, scenario.dump(), scenario.seed, TICK_S, scenario.tier, versions())
    recorder.write(start, 0.0)
    recorder.write(events.RouteEvent(scenario.mission.route()), 0.0)
    recorder.flush()


def _set_up(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    localizer: object,
    request: BackendRequest,
    recorder: Recorder,
    watch: Stopwatch,
) -> Run:
    """The robot and all that drives it; what fails half way leaves the robot at rest and released."""
    with watch.measure("setup"):
        backend = scenario.backend.create(request)
    try:
        return _prepare(scenario, strategies, localizer, backend, recorder, watch)
    except BaseException:
        backend.safe_stop()
        backend.close()
        raise


def _prepare(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    make_localizer: object,
    backend: Backend,
    recorder: Recorder,
    watch: Stopwatch,
) -> Run:
    route = scenario.mission.route()
    journal = RunJournal(recorder, backend.clock, route)
    faults = FaultSchedule(scenario.faults, backend)
    journal.hear = faults.sightings.hear
    devices = faults.wrap(backend.devices)
    services = Services(
        clock=backend.clock,
        devices=devices,
        rig=backend.rig,
        localizer=_localizer(make_localizer, devices, backend),
        classification=Classification(prior_pose(route[0]), backend.rig, backend.clock),
        pool=Pool(strategies, journal.strategy),
        journal=journal,
    )
    inputs = {"route": route, **scenario.mission.tree_inputs}
    built = build(scenario.tree, services, inputs, strategy_trees(strategies))
    return Run(
        root=built.root,
        trace=built.trace,
        paths=built.paths,
        services=services,
        backend=backend,
        journal=journal,
        recorder=recorder,
        stopwatch=watch,
        time_limit_s=scenario.time_limit_s,
        each_tick=lambda: faults.tick(journal, route),
        invalid=lambda: faults.conclude(journal),
    )


def _localizer(make: object, devices: Devices, backend: Backend) -> Localizer:
    if not callable(make):
        raise PluginError(f"got a localizer {make!r}, expected something to call")
    made: Localizer = make(devices=devices, rig=backend.rig, clock=backend.clock)
    return made


def _conclude(scenario: ResolvedScenario, folder: Path, end: RunEnd, watch: Stopwatch) -> Finished:
    record, truth = folder / "record.mcap", folder / "truth.mcap"
    figures = RunFigures(
        wall_s=round(watch.elapsed_s(), 3),
        wall={part: round(spent, 3) for part, spent in sorted(watch.spent_s.items())},
        waypoints_total=len(scenario.mission.waypoints),
    )
    result = summarise(record, truth, figures)
    result["expectations"] = judge(scenario.expect, result)
    write_result(folder / "result.json", result)
    write_report(folder, _tree_svg(folder))
    return Finished(folder, json.loads((folder / "result.json").read_text()), _exit_code(end, result))


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"got {folder}: {error.strerror}, expected a folder that can be written to"
        raise ConfigError([Problem("--out", 1, 1, message)]) from None


def _write_traceback(folder: Path, defect: BaseException) -> None:
    (folder / "traceback.txt").write_text("".join(traceback.format_exception(defect)))


def _unwrite(folder: Path, made: bool) -> None:
    for name in RUN_FILES:
        (folder / name).unlink(missing_ok=True)
    if made:
        folder.rmdir()


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
    return draw(scenario.tree, form, strategy_trees(load_strategies()), last_outcomes(folder))


def last_outcomes(folder: Path) -> dict[str, str]:
    """The status with which each node last ended, by path."""
    changes = History.of(folder / "record.mcap").all(events.NodeChange)
    return {at.event.path: at.event.status for at in changes if at.event.status != "invalid"}


def strategy_trees(strategies: Sequence[Strategy]) -> dict[str, TreeSpec]:
    """The strategies' own sub-trees by name; ConfigError with what is wrong in them."""
    return {strategy.name: load_tree(strategy.tree) for strategy in strategies}


def _exit_code(end: RunEnd, result: dict[str, Any]) -> int:
    if end.outcome == "error":
        return DEFECT
    if end.outcome == "invalid":
        return OTHERWISE
    if result["expectations"]:
        return REACHED if all(row["met"] for row in result["expectations"]) else OTHERWISE
    return REACHED if end.outcome == "reached" else OTHERWISE


def _free_folder(parent: Path, name: str) -> Path:
    """`parent/name`, or with the first free number behind it."""
    folder, number = parent / name, 2
    while folder.exists():
        folder, number = parent / f"{name}-{number}", number + 1
    return folder
