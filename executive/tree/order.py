"""In which order the values of a tree are set: what is read before it is certain to have been written.

What is certain grows along every path, so the first time through a node is the hardest: one pass will do for
loops and retries.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from executive.config.source import Mark
from executive.core.errors import Problem

Known = frozenset[str]
"""The names that are certain to be set."""


@dataclass(frozen=True)
class Ends:
    """What is certain once a node has succeeded, and once it has failed; None where it cannot end so."""

    succeeded: Known | None
    failed: Known | None


Child = Callable[[Known], Ends]
"""Goes through a child with what is certain before it; notes what it reads too early."""


def both(one: Known | None, other: Known | None) -> Known | None:
    """What is certain whichever of two ways was taken."""
    if one is None or other is None:
        return other if one is None else one
    return one & other


def in_turn(before: Known, children: Sequence[Child], *, until: bool) -> Ends:
    """Children one after the other: on after a success, or with `until` after a failure."""
    here: Known | None = before
    ended: Known | None = None
    for child in children:
        if here is None:
            break  # nothing that follows can run
        ends = child(here)
        here, away = (ends.failed, ends.succeeded) if until else (ends.succeeded, ends.failed)
        ended = both(ended, away)
    return Ends(ended, here) if until else Ends(here, ended)


@dataclass(frozen=True)
class TreeOrder:
    """What a tree asks of whoever uses it, and what it gives.

    `needs` are the ports that it may read before it has written them; `sets` those that are certain to be set
    when it has succeeded.
    """

    needs: Known = frozenset()
    sets: Known | None = frozenset()


@dataclass(frozen=True)
class Early:
    """A name read where it may be unset, and where that stands in the file."""

    name: str
    words: str
    mark: Mark
    offset: int | None = None

    def problem(self) -> Problem:
        """The complaint, at its place."""
        return self.mark.problem(
            f"got {self.words}, which may not be set yet here, expected a node before that writes it",
            self.offset,
        )


def first_of_each(found: Sequence[Early]) -> Iterator[Problem]:
    """Each place once, in the order in which it is come by."""
    yield from dict.fromkeys(early.problem() for early in found)
