"""Faults of the executive's own nodes: forced, hanging, raising, ticked late."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, Self

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from executive.core.errors import NodeRaised
from executive.core.types import Outcome, Reason
from executive.core.units import Duration
from executive.run import Cue, FaultSpec, TreeParts
from proving.faults.parameters import Parameters
from proving.faults.reticked import NodeFault, Reticked, root_of

At = Literal["before", "after"]


class NodeName(Parameters):
    """Which node; all that are called so are meant."""

    node: Annotated[
        str,
        Field(min_length=1, description="its name, or as much of its path as tells it: back_off/localise#2"),
    ]


class Forcing(NodeName):
    """Which node is forced to which status, and whether it gets its tick before."""

    status: Annotated[
        Literal["success", "failure", "running"], Field(description="what the node shows its parent")
    ] = "failure"
    at: Annotated[
        At, Field(description="before: the node is not ticked at all; after: ticked, its status replaced")
    ] = "after"
    reason: Annotated[Reason | None, Field(description="what a forced failure says of itself")] = None
    times: Annotated[
        int | None, Field(ge=1, description="how many of its ticks; all, where it is not said")
    ] = None

    @model_validator(mode="after")
    def only_failures_have_reasons(self) -> Self:
        if self.reason is not None and (self.status != "failure" or self.reason is Reason.DONE):
            text = f"got the reason {self.reason} of a {self.status}, expected one of a failure"
            raise PydanticCustomError("located", "{text}", {"text": text})
        return self


class NodeForced(NodeFault):
    """A node shows a status that is not its own. One forced to end is halted if it is under way.

    Failing for a `reason` it says so as if the reason were its own, so that the pool answers it.
    """

    def __init__(self, parameters: Forcing) -> None:
        super().__init__(parameters.node)
        self._status, self._at = Status[parameters.status.upper()], parameters.at
        self._reason, self._left = parameters.reason, parameters.times

    def wrap_tree(self, tree: TreeParts, cue: Cue) -> None:
        self._fail = tree.fail
        super().wrap_tree(tree, cue)

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        if self._left == 0:
            yield from node.run()
            return
        self._left = None if self._left is None else self._left - 1
        if self._at == "after":
            yield from node.run()
        if self._at == "before" or self._status is not Status.RUNNING:
            own = node.own
            node.halt()
            self.altered += self._at == "before" or own is not self._status
        else:
            self.altered += node.own is not Status.RUNNING
        node.show(self._status)
        if self._reason is not None:
            self._fail(node.path, Outcome(self._reason, "forced"))


class NodeHangs(NodeFault):
    """A node is entered, and then nothing more comes of it; what it has started goes on by itself."""

    def __init__(self, parameters: NodeName) -> None:
        super().__init__(parameters.node)

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        entered = node.showing is Status.RUNNING
        if not entered:
            yield from node.run()
        self.altered += entered or node.own is not Status.RUNNING
        node.show(Status.RUNNING)


class Raising(NodeName):
    """Which node raises, and whether it gets its tick before."""

    at: Annotated[At, Field(description="raises before its tick, or after it, with all it has started")] = (
        "after"
    )


class Injected(RuntimeError):
    """What a node raises by injection."""


class NodeRaises(NodeFault):
    """A node raises: a defect, which ends the run as an error, the rover at rest."""

    def __init__(self, parameters: Raising) -> None:
        super().__init__(parameters.node)
        self._at = parameters.at

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        if self._at == "after":
            yield from node.run()
        self.altered += 1
        raise NodeRaised(node.path, Injected("raised by injection"))


class TickLateness(Parameters):
    """How late."""

    by: Annotated[Duration, Field(gt=0, le=86_400, description="mission time from one tick to the next")] = (
        30.0
    )


class LateTick(NodeFault):
    """The tree is ticked only once in a while, as if the computer were busy; time and devices go on."""

    def __init__(self, parameters: TickLateness) -> None:
        super().__init__("")
        self._by_s = parameters.by
        self._last_tick = 0

    def wrap_tree(self, tree: TreeParts, cue: Cue) -> None:
        self.replace(Reticked(*root_of(tree)), cue)

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        due = cue.clock.ticks >= self._last_tick + cue.clock.ticks_for(self._by_s)
        if due or node.own is not Status.RUNNING:
            self._last_tick = cue.clock.ticks
            yield from node.run()
        else:
            self.altered += 1


NODE_FORCED = FaultSpec(
    "node_forced",
    "A node of the tree shows a status that is not its own.",
    Forcing,
    NodeForced,
    "",
    category="executive",
    node="node",
)
NODE_HANGS = FaultSpec(
    "node_hangs",
    "A node of the tree is entered and runs for ever, doing nothing; what it has started goes on.",
    NodeName,
    NodeHangs,
    "",
    category="executive",
    node="node",
)
NODE_RAISES = FaultSpec(
    "node_raises",
    "A node of the tree raises: a defect, so that the run ends as an error.",
    Raising,
    NodeRaises,
    "",
    category="executive",
    node="node",
)
LATE_TICK = FaultSpec(
    "late_tick",
    "The tree is ticked only once in a while, while time passes and devices go on.",
    TickLateness,
    LateTick,
    "",
    category="executive",
)
