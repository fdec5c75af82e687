"""A signal: a number over mission time that triggers and expectations speak of by its name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from executive.core.registry import Kind
from executive.core.values import ValueType


@dataclass(frozen=True, eq=False)
class Signal:
    """One number, taken out of events of these types; `read` gives None where an event does not have it.

    `truth` signals are in the simulator's record only: expectations may speak of them, triggers not.
    """

    name: str
    kind: ValueType[Any]
    events: tuple[type[object], ...]
    read: Callable[[Any], float | bool | None]
    doc: str
    truth: bool = False


def _broken(signal: Signal) -> Iterator[str]:
    if not signal.name.isidentifier():
        yield f"its name is no identifier: {signal.name!r}"
    if not signal.doc.strip():
        yield "it does not say what it is"
    if signal.kind.python not in (float, int, bool):
        yield f"a {signal.kind.name} is no number"


SIGNAL_KIND: Kind[Signal] = Kind(
    "signal", "signals", "A number over mission time, for triggers and expectations.", Signal, check=_broken
)
