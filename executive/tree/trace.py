"""What one tree did last, kept beside it: who is entered, what ended and why, and an alarm from outside."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from py_trees.common import Status

from executive.core.types import Outcome

if TYPE_CHECKING:
    from executive.tree.nodes.leaf import Leaf


class Trace:
    """Who was entered and not yet terminated, the last failure, the outcomes since somebody took them."""

    def __init__(self) -> None:
        self.entered: dict[str, Leaf] = {}
        self.last_failure: tuple[str, Outcome[object]] | None = None
        self._ended: dict[str, Outcome[object]] = {}
        self._alarm: Outcome[object] | None = None

    def end(self, path: str, outcome: Outcome[object]) -> None:
        """A node has ended, and says how."""
        self._ended[path] = outcome

    def fail(self, path: str, outcome: Outcome[object]) -> None:
        """A node has failed, and says why."""
        self.last_failure = (path, outcome)
        self.end(path, outcome)

    def take_ended(self) -> Mapping[str, Outcome[object]]:
        """The outcome of every node that ended since this was asked last, by path."""
        ended, self._ended = self._ended, {}
        return ended

    def raise_alarm(self, outcome: Outcome[object]) -> None:
        """Fail the next leaf found under way with this outcome, whatever it does."""
        self._alarm = outcome

    @property
    def alarmed(self) -> bool:
        """Whether an alarm is raised that no leaf has answered yet."""
        return self._alarm is not None

    def take_alarm(self) -> Outcome[object] | None:
        """The alarm, for the leaf that fails by it; None where there is none."""
        alarm, self._alarm = self._alarm, None
        return alarm

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
