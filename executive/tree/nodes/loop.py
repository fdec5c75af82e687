"""Do something until a condition is met."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Composite

from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities, only, where
from executive.tree.nodes.control import Children, ControlNode, NodeContext
from executive.tree.order import Child, Ends, Known


class Loop(ControlNode):
    """Ask the first child; until it succeeds, run the second and ask again; fail when that fails."""

    symbol = "↺"
    children = Children.TWO
    roles = ("the condition", "the action")

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        until, do = children
        return _Loop(context.name, until, do)

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        until, do = inside
        goes_on = FAILS in until and SUCCEEDS in do  # the condition is asked again in a later tick
        return only(until, SUCCEEDS, RUNS) | only(do, FAILS, RUNS) | where(goes_on, RUNS)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        until, do = children
        asked = until(before)
        return Ends(asked.succeeded, None if asked.failed is None else do(asked.failed).failed)


class _Loop(Composite):
    """Ask `until`; on failure run `do` and ask again; succeed when the answer is yes, fail when `do` fails.

    py_trees' Retry and Repeat both mix up a question's no with an action's failure; this does not.
    `until` is asked before the first `do`, and again after each. One `do` at most is begun per tick.
    """

    def __init__(self, name: str, until: Behaviour, do: Behaviour) -> None:
        super().__init__(name, [until, do])
        self.until, self.do = until, do

    def tick(self) -> Iterator[Behaviour]:
        if self.status is not Status.RUNNING:
            self.current_child = self.until
            self.initialise()
        if self.current_child is self.until:
            yield from self.until.tick()
            if self.until.status is not Status.FAILURE:
                yield from self._end(self.until.status)
                return
            self.current_child = self.do
        yield from self.do.tick()
        if self.do.status is Status.SUCCESS:
            yield from self.until.tick()
            self.current_child = self.do if self.until.status is Status.FAILURE else self.until
            after = Status.RUNNING if self.until.status is Status.FAILURE else self.until.status
            yield from self._end(after)
            return
        yield from self._end(self.do.status)

    def _end(self, status: Status) -> Iterator[Behaviour]:
        if status in (Status.SUCCESS, Status.FAILURE):
            self.stop(status)
        self.status = status
        yield self
