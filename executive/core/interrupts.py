"""Signals that ask a command to end: raised where the work is, held back while an end is written down."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupted(KeyboardInterrupt):
    """A signal asked for the end; `number` is its own."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.number = number


def number_of(interrupt: BaseException | None) -> int:
    """The signal behind an interrupt: Ctrl-C where it does not say."""
    return interrupt.number if isinstance(interrupt, Interrupted) else int(signal.SIGINT)


def words_of(interrupt: BaseException) -> str:
    """Who interrupted, for people."""
    number = number_of(interrupt)
    by = "the operator" if number == signal.SIGINT else signal.Signals(number).name
    return f"interrupted by {by}"


def raise_when_asked() -> None:
    """From now on each of these signals raises `Interrupted` in the main thread."""

    def asked(number: int, frame: FrameType | None) -> None:
        raise Interrupted(number)

    for number in ENDING:
        signal.signal(number, asked)
    sys.unraisablehook = _swallowed


def raise_swallowed() -> None:
    """Raise what was asked where it could not be raised, as in a call from a library's machine code."""
    if _SWALLOWED:
        raise _SWALLOWED.pop()


_SWALLOWED: list[Interrupted] = []


def _swallowed(unraisable: sys.UnraisableHookArgs) -> None:
    if isinstance(unraisable.exc_value, Interrupted):
        _SWALLOWED.append(unraisable.exc_value)  # nothing is shown; the run ends at its next tick
    else:
        sys.__unraisablehook__(unraisable)


@contextmanager
def held_back() -> Iterator[None]:
    """Let what is written here be written whole: whoever asks meanwhile is not heard, the end is near."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in ENDING} if can_handle() else {}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def can_handle() -> bool:
    """Only the main thread may say what becomes of signals."""
    return threading.current_thread() is threading.main_thread()
