"""A node of the built tree with its tick replaced, so that py_trees' invariants hold."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.run import Cue, TreeParts
from executive.tree.addresses import matches
from proving.faults.altered import Counted


class Reticked:
    """A node, its own tick, and what it shows its parent, which may be another status than its own.

    `own` is the status that the node has by itself. It gets that back before it is ticked, so that it never
    goes on with what it has not begun; unless somebody has halted it meanwhile.
    """

    def __init__(self, path: str, node: Behaviour) -> None:
        self.path, self.node = path, node
        self.own = self.showing = node.status
        self._tick: Callable[[], Iterator[Behaviour]] = node.tick

    def look(self) -> None:
        """See whether somebody has halted the node since it was last shown."""
        if self.node.status is not self.showing:
            self.own = self.showing = self.node.status

    def run(self) -> Iterator[Behaviour]:
        """The node's own tick, yielding all but the node itself; it shows its own status afterwards."""
        self.node.status = self.own
        for each in self._tick():
            if each is not self.node:
                yield each
        self.own = self.showing = self.node.status

    def halt(self) -> None:
        """Halt the node if it is under way."""
        self.node.status = self.own
        if self.own is Status.RUNNING:
            self.node.stop(Status.INVALID)
        self.own = self.showing = self.node.status

    def show(self, status: Status) -> None:
        """Let the parent see this status."""
        self.node.status = self.showing = status


class NodeFault(Counted):
    """What becomes of the ticks of every node that an address means. Subclasses write `tick`."""

    def __init__(self, node: str) -> None:
        self._node = node

    def wrap_tree(self, tree: TreeParts, cue: Cue) -> None:
        for path, node in tree.nodes.items():
            if matches(self._node, path):
                self.replace(Reticked(path, node), cue)

    def replace(self, node: Reticked, cue: Cue) -> None:
        """Let `tick` stand for the node's tick while the fault is there."""

        def tick() -> Iterator[Behaviour]:
            node.look()
            yield from self.tick(node, cue) if cue.active else self.untouched(node)
            yield node.node

        vars(node.node)["tick"] = tick  # of this node only, not of its class

    def untouched(self, node: Reticked) -> Iterator[Behaviour]:
        """The node's tick while the fault is not there."""
        return node.run()

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        raise TypeError(f"{type(self).__name__} does nothing to a tick")


def root_of(tree: TreeParts) -> tuple[str, Behaviour]:
    """The path and behaviour of the root."""
    return next((path, node) for path, node in tree.nodes.items() if node.parent is None)
