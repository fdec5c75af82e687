"""A run put together: robot, faults, localizer, classification, pool and tree."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from executive.config.backends import BackendRequest
from executive.core.clock import Stopwatch
from executive.core.ports import Backend
from executive.core.types import (
    Outcome,
    PoseEstimate,
    PoseSource,
    Reason,
    Segment,
)
from executive.inject.faults import TreeParts
from executive.inject.schedule import FaultSchedule
from executive.isc.classification import Classification
from executive.isc.prediction import quat_from_heading_tilt
from executive.navigation.belt_rest import RestingTracks
from executive.pool.pool import Pool, Strategy
from executive.record import events
from executive.record.command_log import logged
from executive.record.journal import RunJournal
from executive.record.recorder import Recorder
from executive.record.versions import versions
from executive.run.runner import Run
from executive.run.scenario import ResolvedScenario
from executive.tree.build import build
from executive.tree.nodes.services import Services
from executive.tree.strategies import strategy_trees

TICK_S = 1.0


def prior_pose(first: Segment) -> PoseEstimate:
    """What ground knows before the first fix: the rover stands near the first way-point, heading outward."""
    heading = math.atan2(first.start.y_m, first.start.x_m)
    return PoseEstimate(
        time_s=0.0,
        position_site_m=(first.start.x_m, first.start.y_m, 0.0),
        quat_site_body=quat_from_heading_tilt(heading, 0.0, 0.0),
        covariance=np.diag([0.05**2, 0.05**2, 0.20**2, 0.1**2, 0.1**2, 0.6**2]),
        source=PoseSource.PRIOR,
    )


def write_start(recorder: Recorder, scenario: ResolvedScenario) -> None:
    start = events.Start(scenario.name, scenario.dump(), scenario.seed, TICK_S, scenario.tier, versions())
    recorder.write(start, 0.0)
    recorder.write(events.RouteEvent(scenario.mission.route()), 0.0)
    recorder.flush()


def set_up(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    request: BackendRequest,
    recorder: Recorder,
    watch: Stopwatch,
) -> Run:
    """The robot and all that drives it; what fails half way leaves the robot at rest and released."""
    with watch.measure("setup"):
        backend = scenario.backend.create(request)
    try:
        return _prepare(scenario, strategies, backend, recorder, watch)
    except BaseException:
        backend.safe_stop()
        backend.close()
        raise


def _prepare(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    backend: Backend,
    recorder: Recorder,
    watch: Stopwatch,
) -> Run:
    route = scenario.mission.route()
    journal = RunJournal(recorder, backend.clock, route)
    faults = FaultSchedule(scenario.faults, backend, scenario.seed)
    journal.hear = faults.sightings.hear
    strategies = faults.wrap_pool(strategies)
    devices = logged(faults.wrap(backend.devices), journal.write)
    belts = RestingTracks(devices.tracks)
    devices = replace(devices, tracks=belts)
    localizer = scenario.localizer.made(devices, backend.rig, backend.clock, scenario.seed, scenario.tier)
    services = Services(
        clock=backend.clock,
        devices=devices,
        rig=backend.rig,
        localizer=faults.wrap_localizer(localizer),
        classification=Classification(prior_pose(route[0]), backend.rig, backend.clock),
        pool=Pool(strategies, journal.strategy),
        journal=journal,
    )
    inputs = {"route": route, **scenario.mission.tree_inputs}
    built = build(scenario.tree, services, inputs, strategy_trees(strategies, scenario.instead))
    faults.wrap_tree(TreeParts(built.paths, built.store.values, built.trace.fail))

    def each_tick() -> None:
        faults.tick(journal, route)
        telemetry = services.classification.telemetry
        problem = belts.astray(telemetry.tracks) if telemetry else None
        if problem is not None:
            built.trace.alarm = Outcome(Reason.DEVICE, problem)

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
        each_tick=each_tick,
        invalid=lambda: faults.conclude(journal),
    )
