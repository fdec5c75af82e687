"""A bench for leaves and trees: the fake robot with all that a leaf can ask for, ticked without a run.

bench = Bench()
assert bench.run(Wait, duration=3.0).ticks == 4
assert bench.run_tree("{sequence: [{wait: {duration: 3 s}}, settle]}").outcome.ok
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from textwrap import indent
from typing import Any

from py_trees.common import Status

from executive.config.backends import BackendRequest
from executive.core.rig import RigCalibration
from executive.core.types import Outcome, Point, Reason, Segment
from executive.isc import Classification, known_channels, known_hypotheses
from executive.pool import FIRST_FITTED, Pool, Strategy
from executive.record.bus import EventBus
from executive.record.journal import RunJournal
from executive.run.assembly import TICK_S, prior_pose
from executive.testing.fake import FakeBackend, FakeWorld, OverheadLocalizer
from executive.tree.build import BuiltTree, build
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree, load_tree_text
from executive.tree.node_type import NodeClass, NodeType
from executive.tree.nodes.base import REQUIRED, FromTree, Leaf, Store, Trace
from executive.tree.nodes.services import Services
from executive.tree.spec import TreeSpec
from executive.tree.strategies import strategy_trees

PATIENCE_TICKS = 10_000
ROUTE = (Segment(Point(2.2, -0.5), Point(2.4, -0.5), 0.03, 0.25, 0.03, 0),)
UNDER_WAY: Outcome[object] = Outcome(Reason.TIMEOUT, f"not ended after {PATIENCE_TICKS} ticks")


@dataclass(frozen=True)
class Ended:
    """How a leaf or tree ended, after how many ticks, and the values by name as it left them."""

    outcome: Outcome[object]
    ticks: int
    values: Mapping[str, object]


class Bench:
    """The fake robot at the start of a short route, and what leaves are given to work with.

    `services`, `backend` and `robot` may be looked at and altered between runs; `events` is the record.
    `own` node types are known to trees beside those registered; the pool has `strategies`.
    """

    def __init__(
        self,
        world: FakeWorld | None = None,
        route: tuple[Segment, ...] = ROUTE,
        own: Iterable[NodeClass] = (),
        strategies: tuple[Strategy, ...] = (),
        seed: int = 0,
    ) -> None:
        request = BackendRequest(
            world or FakeWorld(), route, seed, "geometric", RigCalibration(), None, TICK_S
        )
        self.route, self.own, self.strategies = route, tuple(own), strategies
        self.backend = FakeBackend(request)
        self.robot = self.backend.robot
        self.events: list[object] = []
        clock = self.backend.clock
        journal = RunJournal(EventBus(clock, (lambda event, now_s: self.events.append(event),)), route)
        self.services = Services(
            clock=clock,
            devices=self.backend.devices,
            rig=self.backend.rig,
            localizer=OverheadLocalizer(self.backend.devices, self.backend.rig, clock),
            classification=Classification(
                prior_pose(route[0]),
                self.backend.rig,
                clock,
                known_hypotheses(self.backend.devices.names),
                known_channels(self.backend.devices.names),
            ),
            pool=Pool(strategies, journal.strategy, FIRST_FITTED),
            journal=journal,
        )

    def run(self, leaf: type[Leaf], at_most: int = PATIENCE_TICKS, **values: object) -> Ended:
        """Tick a leaf to its end, or `at_most` so often, its ports given in SI.

        TypeError for a port that it lacks or misses.
        """
        name, store, trace = leaf.name, Store(), Trace()
        ports = {port.name: port for port in leaf.ports()}
        strange = [name for name in values if name not in ports]
        if strange:
            raise TypeError(f"{name}: got the unknown port {strange[0]!r}, expected one of {list(ports)}")
        for port in ports.values():
            default = None if isinstance(port.default, FromTree) else port.default
            if port.name in values or default is not REQUIRED:
                store.values[port.name] = values.get(port.name, default)
            elif port.direction.value != "out":
                raise TypeError(f"{name}: got no {port.name!r} ({port.help})")
        made = leaf(name, name, self.services, {port: store.slot(port) for port in ports}, trace)
        return self._ticked(BuiltTree(made, trace, store, {name: made}), at_most)

    def run_tree(self, tree: str | Path, **inputs: object) -> Ended:
        """Tick a tree to its end: a file, the text of one, or the text of a root node."""
        spec = _spec(tree, node_types(self.own))
        return self._ticked(build(spec, self.services, inputs, strategy_trees(self.strategies)))

    def _ticked(self, tree: BuiltTree, at_most: int = PATIENCE_TICKS) -> Ended:
        """Tick to the end; whatever happens, what was begun is halted and the robot rests."""
        ticks = 0
        try:
            while ticks < at_most:
                ticks += 1
                self.services.classification.tracker.sense(self.services.devices)  # as the runner does
                tree.root.tick_once()
                if tree.root.status is not Status.RUNNING:
                    break
                self.backend.advance()
        finally:
            tree.trace.terminate_entered()
            self.backend.safe_stop()
        return Ended(_outcome(tree), ticks, _values(tree.store))


def _spec(tree: str | Path, known: Mapping[str, NodeType]) -> TreeSpec:
    if isinstance(tree, Path):
        return load_tree(tree, known)
    text = tree if tree.lstrip().startswith("tree:") else f"tree: bench\nroot:\n{indent(tree, '  ')}\n"
    return load_tree_text(text, "bench.yaml", known)


def _outcome(tree: BuiltTree) -> Outcome[object]:
    if tree.root.status is Status.RUNNING:
        return UNDER_WAY
    if tree.root.status is Status.SUCCESS:
        return Outcome(Reason.DONE, tree.root.feedback_message)
    return tree.trace.last_failure[1] if tree.trace.last_failure else Outcome(Reason.GUARD)


def _values(store: Store) -> dict[str, Any]:
    return {key.rpartition(":")[2]: value for key, value in store.values.items()}
