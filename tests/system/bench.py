"""Runs of the shipped trees on the fake robot; the leaves count what happens to them and raise on demand."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from executive.config.backends import BackendRequest
from executive.config.source import read_text
from executive.core.clock import Stopwatch
from executive.core.devices import DRIVE
from executive.core.ports import LocaliseRequest
from executive.core.types import Outcome, Quality, Reason
from executive.isc import Classification, known_channels, known_hypotheses
from executive.pool import (
    Choice,
    Pool,
    Situation,
    Strategy,
)
from executive.record.bus import EventBus
from executive.record.journal import RunJournal
from executive.record.recorder import Recorder
from executive.run.assembly import prior_pose
from executive.run.resolve import as_scenario, resolve
from executive.run.resolved import ResolvedScenario
from executive.run.runner import Run, RunEnd, execute
from executive.testing import FakeBackend, OverheadLocalizer
from executive.tree.build import BuiltTree, build
from executive.tree.nodes.base import Leaf
from executive.tree.nodes.services import Services
from executive.tree.spec import TreeSpec
from executive.tree.strategies import load_strategies, strategy_trees

STEPS, ASIDE_M = 11, (0.008, -0.008)
"""Short legs to and fro: eleven segments, so that what is done once a segment is done more than ten times."""


@dataclass(frozen=True)
class Setting:
    """A shipped tree, and what is made difficult: every `blind_every`-th precise look fails, noisy views."""

    tree: str = "navigate"
    blind_every: int = 0
    pixel_sigma: float = 0.5
    backwards: bool = False
    """Strategies take their turns from the last to the first."""
    only: str = ""
    """The one strategy that is tried wherever it fits: soon for the tenth time."""

    def text(self) -> str:
        points = [{"x": f"{2.2 + 0.06 * i} m", "y": f"{-0.5 + ASIDE_M[i % 2]} m"} for i in range(STEPS + 1)]
        points[0]["tolerance"] = "200 mm"  # so that noisy views let it start at all
        mission = {
            "mission": "short",
            "tree": self.tree,
            "segments": {"on_track": "10 mm", "off_track": "500 mm", "tolerance": "15 mm"},
            "waypoints": points,
        }
        head = {"scenario": "short", "backend": "fake", "localizer": "overhead", "tier": "geometric"}
        world = {"pixel_sigma": self.pixel_sigma}
        return json.dumps(head | {"time_limit": "3 h", "mission": mission, "world": world})


SETTINGS = (
    Setting(blind_every=1),
    Setting(blind_every=1, backwards=True),
    Setting(blind_every=2),
    Setting(blind_every=9),  # seldom enough for a back_off to come to its second turn
    Setting(blind_every=3, only="turning_slip_compensation"),
    Setting(blind_every=3, only="cabin_reposing"),
    Setting(pixel_sigma=15.0, blind_every=4),
    Setting(pixel_sigma=15.0, only="back_off"),
    Setting(pixel_sigma=15.0, blind_every=3, only="back_off"),
    Setting(pixel_sigma=15.0, blind_every=3, only="fresh_look"),
    Setting("dead_reckoning"),
    Setting("dead_reckoning", blind_every=1),
)
"""Together they enter every leaf of the shipped trees and strategies, rare ones soon: each run that breaks
one lasts until then."""


@dataclass(frozen=True)
class Sabotage:
    """The `call`-th call of one method of the leaf at `path` raises: before a step, after a begin, in place
    of a halt, whichever leaves most undone."""

    path: str
    method: str
    call: int


class Broken(RuntimeError):
    """What a sabotaged leaf raises."""


@dataclass
class Diary:
    """How often each leaf was begun, stepped and halted."""

    sabotage: Sabotage | None = None
    begun: Counter[str] = field(default_factory=Counter)
    stepped: Counter[str] = field(default_factory=Counter)
    halted: Counter[str] = field(default_factory=Counter)
    when: dict[Sabotage, int] = field(default_factory=dict)
    """The tick at which a call was made."""

    def watch(self, leaf: Leaf) -> None:
        begin, step, halt = leaf.begin, leaf.step, leaf.halt

        def counted_begin() -> None:
            self.begun[leaf.path] += 1
            begin()
            self.strike(leaf, "begin", self.begun)

        def counted_step() -> Outcome[object] | None:
            self.stepped[leaf.path] += 1
            self.strike(leaf, "step", self.stepped)
            return step()

        def counted_halt() -> None:
            self.halted[leaf.path] += 1
            self.strike(leaf, "halt", self.halted)
            halt()

        leaf.begin, leaf.step, leaf.halt = counted_begin, counted_step, counted_halt

    def strike(self, leaf: Leaf, method: str, counts: Counter[str]) -> None:
        call = Sabotage(leaf.path, method, counts[leaf.path])
        self.when[call] = leaf.services.clock.ticks
        if self.sabotage == call:
            raise Broken(f"{method} is broken")


@dataclass
class Ended:
    """A run on the bench, over."""

    end: RunEnd
    diary: Diary
    built: BuiltTree
    backend: FakeBackend
    record: Path
    rested_by_itself: bool
    """Whether the tracks stood still before the backend was told to stop."""


class InTurn(Pool):
    """Tries the strategies at hand one after the other, whatever the matter is, but for an overshoot."""

    asked, backwards, only = 0, False, ""

    def choose(self, situation: Situation, at_hand: Any = None) -> Choice:
        names = [name for name in sorted(self.strategies, reverse=self.backwards) if name in at_hand]
        name = self.only if self.only in names else names[self.asked % len(names)]
        if situation.failure.reason is Reason.OVERSHOOT and "overshoot_avoidance" in names:
            name = "overshoot_avoidance"
        self.asked += 1
        choice = Choice(situation.time_s, name, *situation.assessment.anomaly, "its turn", ())
        self._note(choice)
        return choice


class Blinking(OverheadLocalizer):
    """Does not see the rover at every n-th precise look (0: always sees it)."""

    every, looks = 0, 0

    def locate(self, request: LocaliseRequest) -> Any:
        self.looks += request.quality is Quality.PRECISE
        if self.every and request.quality is Quality.PRECISE and self.looks % self.every == 0:
            return Ready(Outcome(Reason.NOT_SEEN, "blinked"))
        return super().locate(request)


@dataclass
class Ready:
    """An action that is over."""

    outcome: Outcome[Any]

    def poll(self) -> Outcome[Any]:
        return self.outcome

    def cancel(self) -> None: ...


@cache
def resolved(setting: Setting) -> ResolvedScenario:
    return resolve(as_scenario(read_text(setting.text(), "short.yaml")))


@cache
def strategies() -> tuple[Strategy, ...]:
    return load_strategies()


@cache
def trees() -> dict[str, TreeSpec]:
    return strategy_trees(strategies())


def prepare(setting: Setting, folder: Path, diary: Diary) -> tuple[Run, BuiltTree, FakeBackend]:
    """All that a run needs, put together as the app does, the leaves watched by the diary."""
    scenario = resolved(setting)
    route = scenario.mission.route()
    backend = FakeBackend(
        BackendRequest(scenario.world, route, scenario.seed, scenario.tier, scenario.rig, None, 1.0)
    )
    recorder = Recorder(folder / "record.mcap")
    journal = RunJournal(EventBus(backend.clock, [recorder.write]), route)
    localizer = Blinking(backend.devices, backend.rig, backend.clock)
    localizer.every = setting.blind_every
    pool = InTurn(strategies(), journal.strategy)
    pool.backwards, pool.only = setting.backwards, setting.only
    services = Services(
        clock=backend.clock,
        devices=backend.devices,
        rig=backend.rig,
        localizer=localizer,
        classification=Classification(
            prior_pose(route[0]),
            backend.rig,
            backend.clock,
            known_hypotheses(),
            known_channels(),
            journal.assessment,
            markers_expected=4,
        ),
        pool=pool,
        journal=journal,
    )
    built = build(scenario.tree, services, {"route": route}, trees())
    for node in built.root.iterate():
        if isinstance(node, Leaf):
            diary.watch(node)
    run = Run(
        root=built.root,
        trace=built.trace,
        paths=built.paths,
        services=services,
        backend=backend,
        journal=journal,
        recorder=recorder,
        stopwatch=Stopwatch(),
        time_limit_s=scenario.time_limit_s,
    )
    return run, built, backend


def run(
    setting: Setting,
    folder: Path,
    sabotage: Sabotage | None = None,
    alter: Callable[[Run], Run | None] = lambda run: None,
) -> Ended:
    """Run the tree to its end; `alter` may break something else before it begins."""
    diary = Diary(sabotage)
    prepared, built, backend = prepare(setting, folder, diary)
    moving_at_stop: list[bool] = []
    stop = backend.safe_stop

    def noted_stop() -> None:
        moving_at_stop.append(backend.devices[DRIVE].read().moving)
        stop()

    backend.safe_stop = noted_stop
    end = execute(alter(prepared) or prepared)
    return Ended(end, diary, built, backend, folder / "record.mcap", not any(moving_at_stop))
