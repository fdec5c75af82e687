"""What every leaf must keep."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from executive.core.devices import DRIVE
from executive.core.errors import Breach
from executive.core.types import Outcome, Reason
from executive.testing.bench import PATIENCE_TICKS, UNDER_WAY, Bench, Ended
from executive.tree.nodes.base import Leaf
from executive.tree.nodes.kind import broken_promises


class LeafBreach(Breach):
    """The leaf breaks promises; the message says which."""


def check_leaf(leaf: type[Leaf], **values: Any) -> None:
    """Raise LeafBreach with every promise not kept: of its declaration, and twice run on the fake robot.

    `values` are its ports in SI, as a tree would give them: one case; call again for others.
    """
    broken = list(broken_promises(leaf))
    if not broken:
        broken += _in_use(leaf, values)
    if broken:
        raise LeafBreach(f"leaf {leaf.name}", broken)


def _in_use(leaf: type[Leaf], values: dict[str, Any]) -> Iterator[str]:
    bench = Bench()
    try:
        ended = bench.run(leaf, **values)
    except Exception as error:  # whatever a leaf raises is its defect
        yield f"it raised {type(error).__name__}: {error}"
        return
    yield from _of_end(leaf, ended.outcome)
    if bench.backend.devices[DRIVE].read().moving:
        yield "it left the tracks moving"
    if not _same(ended, Bench().run(leaf, **values)):
        yield "it ends otherwise the second time: its values or the clock are not all that it goes by"
    yield from _when_interrupted(leaf, values)


def _of_end(leaf: type[Leaf], outcome: Outcome[object]) -> Iterator[str]:
    if outcome is UNDER_WAY:
        yield f"it did not end within {PATIENCE_TICKS} ticks"
    elif outcome.reason not in {*leaf.outcomes, Reason.CANCELLED}:
        yield f"it ended with {outcome.reason}, which is not among its outcomes"


def _when_interrupted(leaf: type[Leaf], values: dict[str, Any]) -> Iterator[str]:
    bench = Bench()
    try:
        bench.run(leaf, at_most=1, **values)
    except Exception as error:  # the same
        yield f"it raised when interrupted: {type(error).__name__}: {error}"
    bench.backend.advance()
    if bench.backend.devices[DRIVE].read().moving:
        yield "it leaves the tracks moving when interrupted"


def _same(first: Ended, second: Ended) -> bool:
    return (first.outcome.reason, first.ticks) == (second.outcome.reason, second.ticks)
