"""What takes part in a run beside the executive: the one way to reach into a run, and to judge it.

An instrument owns keys of the scenario. It reads them, wraps what it acts through before the run, hears every
event of the record while the run goes on, and judges the records afterwards. Registered under
`longarm.instruments`; without any, missions run all the same.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, MutableMapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from py_trees.behaviour import Behaviour

from executive.config.source import Source
from executive.core.errors import Problem
from executive.core.ports import Backend, Devices, Localizer
from executive.core.registry import Kind
from executive.core.rig import Rig
from executive.core.types import Outcome
from executive.pool import Strategy
from executive.record.history import History
from executive.record.rows import JudgedRow
from executive.record.run_result import RunResult
from executive.tree.spec import TreeSpec

S = TypeVar("S")
Schema = dict[str, Any]


@dataclass(frozen=True)
class TreeParts:
    """What an instrument may reach of a built tree: every node by its path (outermost behaviour), the values.

    `fail` says in a node's stead that it has failed, and why.
    """

    nodes: Mapping[str, Behaviour]
    values: MutableMapping[str, object]
    fail: Callable[[str, Outcome[object]], None] = lambda path, outcome: None


class Instrument:
    """What takes part in one run. Override what it acts through; all else is left as it is."""

    def wrap_devices(self, devices: Devices) -> Devices:
        """The devices as the executive shall see them."""
        return devices

    def wrap_localizer(self, localizer: Localizer) -> Localizer:
        """The localizer as the executive shall see it."""
        return localizer

    def wrap_pool(self, strategies: tuple[Strategy, ...]) -> tuple[Strategy, ...]:
        """The strategies as the executive shall find them when it starts."""
        return strategies

    def wrap_tree(self, tree: TreeParts) -> None:
        """Alter the behaviours of the built tree, in place."""

    def hear(self, event: object) -> None:
        """An event has been written to the record."""

    def tick(self, now_s: float) -> None:
        """Called once a tick, after sensing and before the tree is ticked."""

    def conclude(self) -> str | None:
        """Called once at the end, with the rover at rest: why the run proves nothing, None if it does."""
        return None


@dataclass(frozen=True)
class Setting:
    """Where a scenario takes place: backend and tier (None: not known), number of way-points."""

    backend: str | None
    tier: str | None
    waypoints: int


@dataclass(frozen=True)
class Context:
    """What an instrument is made with: the robot, the scenario's seed, and its access to the record.

    `write` writes an event at the present mission time; `progress` is the share of the route, 0 to 1, that
    lies behind the rover by the last fix.
    """

    backend: Backend
    seed: int
    write: Callable[[object], None]
    progress: Callable[[], float]


@dataclass(frozen=True)
class Records:
    """What a run left behind. `truth` is empty where none was recorded."""

    history: History
    truth: History
    rig: Rig
    result: RunResult
    """As far as the record tells it: before anything was judged."""


@dataclass(frozen=True)
class Judgement:
    """What an instrument makes of a run: rows for `result.json`, and whether the run was as it should be.

    `met` None: it has no opinion, and the outcome decides.
    """

    expectations: tuple[JudgedRow, ...] = ()
    safety: tuple[JudgedRow, ...] = ()
    met: bool | None = None


class InstrumentSpec(ABC, Generic[S]):
    """A kind of instrument; `S` is what its keys of a scenario come to. Override what it does.

    Everything that is given a source is given the instrument's own keys alone, each where its file has it.
    """

    name: str
    doc: str
    keys: tuple[str, ...] = ()
    """The keys of a scenario that it owns."""
    by_chance: tuple[str, ...] = ()
    """Those in which a distribution may stand for a value."""
    after: tuple[str, ...] = ()
    """Instruments that come before this one, where they are installed; `check` may ask for their settings."""

    def expand(self, source: Source) -> Source:
        """The source with short forms written out."""
        return source

    @abstractmethod
    def read(self, source: Source, setting: Setting) -> S:
        """What the keys say, all defaults where nothing is said; ConfigError with every problem."""

    def check(
        self, source: Source, settings: Mapping[str, object], tree: TreeSpec | None
    ) -> Iterable[Problem]:
        """Problems with what the keys name elsewhere; `tree` None where it could not be read.

        `settings` has what each instrument has read, by name; one whose keys could not be read is missing.
        """
        return ()

    def dump(self, settings: S) -> dict[str, object]:
        """The keys as a file says them, every default written; what need not be said is left out."""
        return {}

    def schema(self, defs: Schema) -> dict[str, Schema]:
        """The JSON Schema of each key; what they refer to is added to `defs`."""
        return {}

    def make(self, settings: S, context: Context) -> Instrument:
        """The instrument of one run."""
        return Instrument()

    def judge(self, settings: S, records: Records) -> Judgement:
        """What the records say; also asked of a run that was killed, so it may rely on nothing else."""
        return Judgement()


INSTRUMENT_KIND: Kind[InstrumentSpec[Any]] = Kind(
    "instrument",
    "instruments",
    "What takes part in a run beside the executive.",
    InstrumentSpec,
    page=lambda spec: {"doc": spec.doc, "keys": list(spec.keys), "after": list(spec.after)},
)
