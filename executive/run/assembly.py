"""A run put together: robot, instruments, localizer, classification, pool and tree."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from executive.config.backends import BackendRequest
from executive.core.clock import Stopwatch
from executive.core.devices import DRIVE
from executive.core.ports import Backend
from executive.core.types import (
    Outcome,
    PoseEstimate,
    PoseSource,
    Reason,
    Segment,
)
from executive.isc import Classification, known_channels, known_hypotheses
from executive.isc.attitude import quat_from_heading_tilt
from executive.navigation.belt_rest import RestingDrive
from executive.pool import Pool, Strategy, known_policy
from executive.record import events
from executive.record.along import AlongRoute
from executive.record.bus import EventBus, Listener
from executive.record.command_log import logged
from executive.record.journal import RunJournal
from executive.record.recorder import Recorder
from executive.record.versions import versions
from executive.run.cuts import Cuts
from executive.run.instrument import Context, TreeParts
from executive.run.instruments import Together, instruments_there_are
from executive.run.resolved import ResolvedScenario
from executive.run.runner import Run
from executive.tree.build import build
from executive.tree.needs import unfit
from executive.tree.nodes.services import Services
from executive.tree.strategies import broken_strategies, strategy_trees

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


def write_start(recorder: Recorder, scenario: ResolvedScenario, text: str) -> None:
    """How the run began; `text` is the scenario as the run folder has it."""
    start = events.Start(scenario.name, text, scenario.seed, TICK_S, scenario.tier, versions())
    recorder.write(start, 0.0)
    recorder.write(events.RouteEvent(scenario.mission.route()), 0.0)
    for broken in broken_strategies():
        without = f"the run does without {broken}"
        recorder.write(events.LogEvent(events.Level.WARNING, "pool", without), 0.0)
    recorder.flush()


def set_up(
    scenario: ResolvedScenario,
    strategies: tuple[Strategy, ...],
    request: BackendRequest,
    recorder: Recorder,
    watch: Stopwatch,
    listeners: Sequence[Listener] = (),
    cuts: Cuts | None = None,
) -> Run:
    """The robot and all that drives it; what fails half way leaves the robot at rest and released."""
    with watch.measure("setup"):
        backend = scenario.backend.create(request)
    try:
        return _prepare(scenario, strategies, backend, recorder, watch, listeners, cuts or Cuts())
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
    listeners: Sequence[Listener],
    cuts: Cuts,
) -> Run:
    route = scenario.mission.route()
    along = AlongRoute(route)
    bus = EventBus(backend.clock, (recorder.write, along.hear, *listeners))
    journal = RunJournal(bus, route)
    context = Context(backend, scenario.seed, bus.publish, along.share)
    instruments = Together([spec.make(scenario.of(spec), context) for spec in instruments_there_are()])
    bus.subscribe(lambda event, time_s: instruments.hear(event))
    strategies = instruments.wrap_pool(strategies)
    devices = logged(instruments.wrap_devices(backend.devices), journal.write)
    belts = RestingDrive(devices[DRIVE])
    devices = devices.replace(DRIVE, belts)
    trees = strategy_trees(strategies, scenario.instead)
    not_for_this_robot = unfit(trees, scenario.backend)
    localizer = scenario.localizer.made(devices, backend.rig, backend.clock, scenario.seed, scenario.tier)
    services = Services(
        clock=backend.clock,
        devices=devices,
        rig=backend.rig,
        localizer=instruments.wrap_localizer(localizer),
        classification=Classification(
            prior_pose(route[0]),
            backend.rig,
            backend.clock,
            known_hypotheses(devices.names),
            known_channels(devices.names),
            announce=journal.assessment,
            markers_expected=scenario.localizer.spec.expected_markers(backend.rig),
        ),
        pool=Pool(strategies, journal.strategy, known_policy(scenario.policy), not_for_this_robot),
        journal=journal,
    )
    inputs = {"route": route, **scenario.mission.tree_inputs}
    built = build(
        scenario.tree, services, inputs, {n: t for n, t in trees.items() if n not in not_for_this_robot}
    )
    instruments.wrap_tree(TreeParts(built.paths, built.store.values, built.trace.fail))

    def each_tick() -> None:
        instruments.tick(backend.clock.now_s)
        sensed = services.classification.tracker.sensed
        problem = belts.astray(sensed.tracks) if sensed else None
        if problem is not None:
            built.trace.raise_alarm(Outcome(Reason.DEVICE, problem))

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
        invalid=instruments.conclude,
        cuts=cuts,
    )
