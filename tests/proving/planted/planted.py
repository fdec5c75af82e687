"""Faults that do to the process what production code never should: a plug-in for the engine's tests."""

from __future__ import annotations

import ctypes
import errno
import os
import signal

from pydantic import BaseModel, ConfigDict

from executive.run.fault import Fault, FaultSpec


class Nothing(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


def segfault():
    ctypes.string_at(0)


def hang():
    while True:
        signal.pause()


def eat_memory():
    eaten = []
    while True:
        eaten.append(b"\1" * 50_000_000)


def fill_disk():
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def raise_error():
    raise RuntimeError("planted")


def exit_at_once():
    os._exit(5)


def be_killed():
    os.kill(os.getpid(), signal.SIGKILL)


def _spec(name, deed):
    class Deed(Fault):
        """Takes effect at its onset and does its deed a tick later, when the record has been flushed."""

        def __init__(self, parameters):
            self.watched = 0

        def watch(self, backend):
            self.watched += 1
            if self.watched > 1:
                deed()

    return FaultSpec(name, deed.__name__, Nothing, Deed, "", category="executive")


SEGFAULT = _spec("segfault", segfault)
HANG = _spec("hang", hang)
EAT_MEMORY = _spec("eat_memory", eat_memory)
FILL_DISK = _spec("fill_disk", fill_disk)
RAISE_ERROR = _spec("raise_error", raise_error)
EXIT_AT_ONCE = _spec("exit_at_once", exit_at_once)
OUTER_KILL = _spec("outer_kill", be_killed)
"""A kill that no scenario asks for by name: as good as one from outside."""
PLANTED_KILL = _spec("process_killed", be_killed)
HARMLESS = _spec("harmless", lambda: None)
