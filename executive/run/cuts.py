"""Where a run was cut off and goes on: it stands still there, and looks before it drives any further."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager

from py_trees.common import Status

from executive.core.devices import DRIVE
from executive.core.types import Outcome, Quality, Reason
from executive.record import events
from executive.record.journal import RunJournal
from executive.tree.nodes.localise import Localise
from executive.tree.nodes.services import Services
from executive.tree.store import Store
from executive.tree.trace import Trace

LOOK = "after_a_cut/look"
"""The path, in the record, of the look with which a run goes on."""


class Cuts:
    """The cuts of one run: `pass_by` at the end of every tick, and look where one is due.

    A run that is repeated has them at the same `ticks`. One that goes on has another, where `caught_up` first
    says that all that was recorded before is recorded again.
    """

    def __init__(self, ticks: Collection[int] = (), caught_up: Callable[[], bool] = lambda: False) -> None:
        self._ticks, self._caught_up = frozenset(ticks), caught_up
        self._to_come = not caught_up()
        self._number, self._fixes_then = 0, 0

    def pass_by(self, services: Services, journal: RunJournal) -> None:
        """Note in the record if the run was cut off at the end of this tick."""
        newest = self._to_come and self._caught_up()
        self._to_come = self._to_come and not newest
        if newest or services.clock.ticks in self._ticks:
            self._number += 1
            self._fixes_then = services.classification.tracker.fixes
            journal.write(events.Resumed(self._number))

    def look_due(self, services: Services) -> bool:
        """Whether the rover moves, and has not been seen since the run was cut off."""
        unseen = services.classification.tracker.fixes == self._fixes_then
        return self._number > 0 and unseen and services.devices[DRIVE].read().moving


class Look:
    """A look of its own beside the tree, whose leaves are suspended meanwhile."""

    def __init__(self, services: Services, trace: Trace, journal: RunJournal) -> None:
        store = Store()
        store.values |= {port.name: port.default for port in Localise.ports()}
        store.values |= {"quality": Quality.PRECISE, "segment": journal.under_way}
        bindings = {name: store.slot(name) for name in store.values}
        self.leaf = Localise("look", LOOK, services, bindings, trace)
        self._trace = trace

    @property
    def under_way(self) -> bool:
        return self.leaf.status in (Status.INVALID, Status.RUNNING)

    @contextmanager
    def standing_still(self) -> Iterator[None]:
        """Suspend every leaf under way, last entered first; afterwards they go on.

        Where the rover was not seen they fail instead, and the tree decides.
        """
        leaves = tuple(leaf for leaf in self._trace.entered.values() if leaf.interruptible)
        for leaf in reversed(leaves):
            leaf.stand_still()
        yield
        unless = None
        if self.leaf.status is not Status.SUCCESS:
            self.leaf.stop(Status.INVALID)
            unless = Outcome[object](Reason.DEVICE, f"not seen after a cut: {self.leaf.feedback_message}")
        for leaf in leaves:
            leaf.go_on(unless)
