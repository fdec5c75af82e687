"""The nodes from a leaf up to the root, with what each was doing at a moment and since when."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from executive.record.events import NodeChange
from executive.record.history import At


@dataclass(frozen=True)
class ChainLink:
    """One node at a moment. `reason` and `detail` say why a leaf ended, empty otherwise."""

    path: str
    status: str
    since_s: float
    reason: str = ""
    detail: str = ""

    @property
    def name(self) -> str:
        return self.path.rsplit("/", 1)[-1]


Chain = tuple[ChainLink, ...]
"""Leaf first, root last; empty where nothing was ticked."""


class Moment:
    """What the tree had done up to a mission time [s], that time included."""

    def __init__(self, changes: Sequence[At[NodeChange]], at_s: float) -> None:
        self.changes = [at for at in changes if at.time_s <= at_s]
        self.inner = {parent for at in changes for parent in parents(at.event.path)}
        self.last: dict[str, At[NodeChange]] = {}
        for at in self.changes:
            self.last.pop(at.event.path, None)  # the latest stands last
            self.last[at.event.path] = at

    def chain(self) -> Chain:
        """From the leaf under way, the last entered of several; else from the one that ended last."""
        leaves = [at for path, at in self.last.items() if path not in self.inner]
        running = [at for at in leaves if at.event.status == "running"]
        ended = [at for at in leaves if at.event.status != "invalid"]
        return self._upwards((running or ended)[-1].event.path) if running or ended else ()

    def failure(self, answered_s: Iterable[float] = (), beside: str = "") -> Chain:
        """From the leaf whose failure last meant something, `beside` not counted, as things stood then.

        That is one which its parent passed on, or which the pool answered at one of `answered_s`; the
        no of a question within a loop or a selector is none.
        """
        answers = set(answered_s)
        failed = {(at.time_s, at.event.path) for at in self.changes if at.event.status == "failure"}
        for at in reversed(self.changes):
            leaf = at.event.path not in {*self.inner, beside} and at.event.status == "failure"
            passed_on = (at.time_s, at.event.path.rpartition("/")[0]) in failed
            if leaf and (passed_on or at.time_s in answers):
                return Moment(self.changes, at.time_s)._upwards(at.event.path)
        return ()

    def _upwards(self, path: str) -> Chain:
        nodes = [path, *reversed(parents(path))]
        return tuple(_link(self.last[node]) for node in nodes if node in self.last)


def parents(path: str) -> list[str]:
    """The paths above a path, the root first."""
    parts = path.split("/")
    return ["/".join(parts[:n]) for n in range(1, len(parts))]


def _link(at: At[NodeChange]) -> ChainLink:
    event = at.event
    return ChainLink(event.path, event.status, at.time_s, event.reason, event.detail)
