"""A run that stands still for as long as its operator wants, between two ticks; it ends as without.

SIGTSTP (Ctrl-Z) stops the process until SIGCONT (`fg`), SIGUSR1 the run until the next SIGUSR1.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from executive.core.interrupts import can_handle

LOOKED_FOR_EVERY_S = 0.05


@contextmanager
def pausable() -> Iterator[Callable[[], None]]:
    """Here these signals are heard. Call what is given between two ticks; it returns when work goes on."""
    asked = {signal.SIGTSTP: False, signal.SIGUSR1: False}

    def hear(number: int, frame: FrameType | None) -> None:
        asked[signal.Signals(number)] ^= True

    def wait_while_paused() -> None:
        if asked[signal.SIGTSTP]:
            asked[signal.SIGTSTP] = False
            stop_process()
        while asked[signal.SIGUSR1]:
            threading.Event().wait(LOOKED_FOR_EVERY_S)

    before = {number: signal.signal(number, hear) for number in asked} if can_handle() else {}
    try:
        yield wait_while_paused
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def stop_process() -> None:
    """Stand still, as a whole process, until SIGCONT."""
    os.kill(os.getpid(), signal.SIGSTOP)
