"""The one way of events: what is published goes to the recorder, and to all who listen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress

from executive.core.clock import Clock

Listener = Callable[[object, float], None]
"""Is told an event and its mission time [s]."""


class EventBus:
    """Tells every event, at the present mission time, to its listeners in their order.

    What a listener raises breaks the run, as for the recorder it must; who only looks on is `harmless`.
    """

    def __init__(self, clock: Clock, listeners: Sequence[Listener]) -> None:
        self._clock, self._listeners = clock, list(listeners)

    def subscribe(self, listener: Listener) -> None:
        """Tell this one too from now on, after the others."""
        self._listeners.append(listener)

    def publish(self, event: object) -> None:
        """Tell everyone."""
        now_s = self._clock.now_s
        for listener in self._listeners:
            listener(event, now_s)


def harmless(listener: Listener) -> Listener:
    """The same listener, whatever it raises left aside."""

    def looking_on(event: object, time_s: float) -> None:
        with suppress(Exception):
            listener(event, time_s)

    return looking_on
