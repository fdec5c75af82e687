"""The leaf: a py_trees behaviour with typed ports, services by constructor, and contained faults.

class Wait(Leaf):
    '''Let mission time pass.'''

    duration = In(DURATION, "how long", default=60.0)
    outcomes = (Reason.DONE,)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import NoneType
from typing import ClassVar, get_args, get_type_hints

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.errors import NodeRaised
from executive.core.types import Outcome, Reason
from executive.tree.declared import Declared
from executive.tree.nodes.services import Services
from executive.tree.ports import PortError
from executive.tree.store import Binding
from executive.tree.trace import Trace


class Leaf(Declared, Behaviour):
    """A leaf of the tree. Subclasses declare ports and write `begin`, `step` and, if needed, `halt`.

    `outcomes` are the reasons it can end with. A `condition` answers at once: its `step` never returns None.
    A leaf that is not `interruptible` is not failed by an alarm from outside.
    """

    outcomes: ClassVar[tuple[Reason, ...]] = (Reason.DONE,)
    condition: ClassVar[bool] = False
    interruptible: ClassVar[bool] = True

    def __init__(
        self, name: str, path: str, services: Services, bindings: Mapping[str, Binding], trace: Trace
    ) -> None:
        super().__init__(name)
        self._refused: Outcome[object] | None = None
        self.path, self.services, self.bindings, self.trace = path, services, bindings, trace

    @classmethod
    def takes_time(cls) -> bool:
        """Whether a step may leave the leaf under way, as the type of what it returns says."""
        returned = get_type_hints(cls.step).get("return")
        return returned is None or NoneType in get_args(returned)

    def begin(self) -> None:
        """Called when the leaf is entered, before its first step."""

    def step(self) -> Outcome[object] | None:
        """One tick's work: None while under way."""
        raise TypeError(f"{type(self).__name__} has no step")

    def halt(self) -> None:
        """Called once when an entered leaf ends or is interrupted; must leave its device safe."""

    def suspend(self) -> None:
        """Called where a run that was cut off goes on: rest, while it is looked where the rover is."""
        self.halt()

    def resume(self) -> None:
        """Called after that look: do what is left to do. By default the leaf begins anew."""
        self.begin()

    def initialise(self) -> None:
        self.trace.entered[self.path] = self
        self._begun(self.begin)

    def stand_still(self) -> None:
        """Suspend the leaf, whose errors are its own."""
        with ErrorsOf(self.path):
            self.suspend()

    def go_on(self, unless: Outcome[object] | None) -> None:
        """Resume a suspended leaf; or let it end with this outcome at its next step."""
        self._begun(self.resume if unless is None else _nothing)
        self._refused = self._refused or unless

    def _begun(self, begin: Callable[[], None]) -> None:
        self._refused = None
        with ErrorsOf(self.path):
            try:
                begin()
            except PortError as error:
                self._refused = error.outcome

    def update(self) -> Status:
        with ErrorsOf(self.path):
            outcome = self._stepped()
        if outcome is None:
            self.feedback_message = ""
            return Status.RUNNING
        self.feedback_message = outcome.detail or outcome.reason.value
        if not outcome.ok:
            self.trace.fail(self.path, outcome)
            return Status.FAILURE
        self.trace.end(self.path, outcome)
        return Status.SUCCESS

    def _stepped(self) -> Outcome[object] | None:
        """What this tick comes to. A port without a value ends the leaf, in `begin` as in `step`."""
        try:
            return self._refused or self._alarmed() or self.step()
        except PortError as error:
            return error.outcome

    def _alarmed(self) -> Outcome[object] | None:
        """What ends a leaf that is under way from outside. One that answers at once never is."""
        if not self.trace.alarmed or not self.interruptible or self.status is not Status.RUNNING:
            return None
        alarm = self.trace.take_alarm()
        if alarm is not None:
            self.services.classification.on_failure(alarm)
        return alarm

    def terminate(self, new_status: Status) -> None:
        if self.trace.entered.pop(self.path, None) is not None or new_status is not Status.INVALID:
            with ErrorsOf(self.path):
                self.halt()


def _nothing() -> None:
    """What a leaf does that is not to go on."""


class ErrorsOf:
    """Names the node on any exception that passes, once."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __enter__(self) -> None: ...

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, Exception) and not isinstance(error, NodeRaised):
            raise NodeRaised(self.path, error) from error
