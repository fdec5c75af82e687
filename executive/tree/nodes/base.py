"""The leaf: a py_trees behaviour with typed ports, services by constructor, and contained faults.

A leaf class declares its ports as class attributes; the declaration is the single source for validation,
JSON Schema, `longarm nodes` and the Groot2 model:

    class Wait(Leaf):
        '''Let mission time pass.'''

        duration = In(DURATION, "how long", default=60.0)
        outcomes = (Reason.DONE,)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, ClassVar, Generic, TypeVar, overload

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.errors import NodeRaised
from executive.core.types import Outcome, Reason
from executive.core.values import ValueType
from executive.tree.nodes.services import Services

T = TypeVar("T")


class Direction(StrEnum):
    IN = "in"
    OUT = "out"
    INOUT = "inout"


@dataclass(frozen=True)
class FromTree:
    """A default that means: the tree's own value of this name, if the tree has one (else None)."""

    name: str


class _Required:
    def __repr__(self) -> str:
        return "required"


REQUIRED = _Required()


@dataclass(frozen=True)
class PortSpec:
    """One declared port, as the catalogue shows it. `default` is REQUIRED, FromTree or a value."""

    name: str
    type: ValueType[Any]
    direction: Direction
    help: str
    default: object = REQUIRED


class Store:
    """The values of one tree, keyed by scope and name. Two trees never share one; it can be pickled."""

    def __init__(self) -> None:
        self.values: dict[str, object] = {}

    def slot(self, key: str) -> Slot:
        return Slot(self, key)


@dataclass(frozen=True)
class Slot:
    """A named place in a store. Unset until written."""

    store: Store
    key: str

    def read(self) -> Any:
        return self.store.values.get(self.key)

    def write(self, value: object) -> None:
        self.store.values[self.key] = value


@dataclass(frozen=True)
class Constant:
    """A literal from the file."""

    value: object

    def read(self) -> Any:
        return self.value

    def write(self, value: object) -> None:
        raise TypeError("a literal cannot be written to")


Binding = Slot | Constant


class _Port(Generic[T]):
    direction: ClassVar[Direction]

    def __init__(self, type: ValueType[T], help: str, default: object = REQUIRED) -> None:
        self.type, self.help, self.default = type, help, default
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, leaf: None, owner: type) -> _Port[T]: ...
    @overload
    def __get__(self, leaf: Leaf, owner: type) -> T: ...
    def __get__(self, leaf: Leaf | None, owner: type) -> _Port[T] | T:
        if leaf is None:
            return self
        value: T = leaf.bindings[self.name].read()
        return value

    def spec(self) -> PortSpec:
        return PortSpec(self.name, self.type, self.direction, self.help, self.default)


class In(_Port[T]):
    """A port that the leaf reads."""

    direction = Direction.IN


class _Written(_Port[T]):
    def __set__(self, leaf: Leaf, value: T) -> None:
        leaf.bindings[self.name].write(value)


class Out(_Written[T]):
    """A port that the leaf writes."""

    direction = Direction.OUT


class InOut(_Written[T]):
    """A port that the leaf reads and writes."""

    direction = Direction.INOUT


@dataclass
class Trace:
    """What one tree did last: who was entered and not yet terminated, and the last failure of a leaf.

    `alarm`, once set, fails the next leaf found under way, whatever it does, and is cleared by that.
    `note` is called at every end of a leaf: (path, outcome).
    """

    entered: dict[str, Leaf] = field(default_factory=dict)
    last_failure: tuple[str, Outcome[object]] | None = None
    alarm: Outcome[object] | None = None
    note: Callable[[str, Outcome[object]], None] = lambda path, outcome: None

    def fail(self, path: str, outcome: Outcome[object]) -> None:
        """A node has failed, and says why."""
        self.last_failure = (path, outcome)
        self.note(path, outcome)

    def terminate_entered(self) -> None:
        """Terminate every leaf that was entered and has not ended, last entered first.

        One that raises does not keep the others from it; the first such error is raised at the end.
        """
        first: BaseException | None = None
        while self.entered:
            path, leaf = next(reversed(self.entered.items()))
            try:
                leaf.stop(Status.INVALID)  # halts only while the leaf is still listed as entered
            except BaseException as error:
                first = first or error
            finally:
                self.entered.pop(path, None)
        if first is not None:
            raise first


class Leaf(Behaviour):
    """A leaf of the tree. Subclasses declare ports and write `begin`, `step` and, if needed, `halt`.

    `needs` are the names of the devices without which it cannot do its work.
    """

    outcomes: ClassVar[tuple[Reason, ...]] = (Reason.DONE,)
    heeds_alarm: ClassVar[bool] = True
    needs: ClassVar[tuple[str, ...]] = ()

    def __init__(
        self, name: str, path: str, services: Services, bindings: Mapping[str, Binding], trace: Trace
    ) -> None:
        super().__init__(name)
        self.path, self.services, self.bindings, self.trace = path, services, bindings, trace

    @classmethod
    def ports(cls) -> tuple[PortSpec, ...]:
        """The declared ports, in order of declaration, base classes first."""
        found: dict[str, PortSpec] = {}
        for base in reversed(cls.__mro__):
            for attribute in vars(base).values():
                if isinstance(attribute, _Port):
                    found[attribute.name] = attribute.spec()
        return tuple(found.values())

    def begin(self) -> None:
        """Called when the leaf is entered, before its first step."""

    def step(self) -> Outcome[object] | None:
        """One tick's work: None while under way."""
        raise TypeError(f"{type(self).__name__} has no step")

    def halt(self) -> None:
        """Called once when an entered leaf ends or is interrupted; must leave its device safe."""

    def initialise(self) -> None:
        self.trace.entered[self.path] = self
        with Naming(self.path):
            self.begin()

    def update(self) -> Status:
        with Naming(self.path):
            outcome = self._alarmed() or self.step()
        if outcome is None:
            self.feedback_message = ""
            return Status.RUNNING
        self.feedback_message = outcome.detail or outcome.reason.value
        if not outcome.ok:
            self.trace.fail(self.path, outcome)
            return Status.FAILURE
        self.trace.note(self.path, outcome)
        return Status.SUCCESS

    def _alarmed(self) -> Outcome[object] | None:
        """What ends a leaf that is under way from outside. One that answers at once never is."""
        alarm = self.trace.alarm
        if alarm is None or not self.heeds_alarm or self.status is not Status.RUNNING:
            return None
        self.trace.alarm = None
        self.services.classification.on_failure(alarm)
        return alarm

    def terminate(self, new_status: Status) -> None:
        if self.trace.entered.pop(self.path, None) is not None or new_status is not Status.INVALID:
            with Naming(self.path):
                self.halt()


class Naming:
    """Names the node on any exception that passes, once."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __enter__(self) -> None: ...

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, Exception) and not isinstance(error, NodeRaised):
            raise NodeRaised(self.path, error) from error
