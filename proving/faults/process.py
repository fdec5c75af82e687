"""Faults of the computer that the executive runs on."""

from __future__ import annotations

import os
import signal

from executive.core.ports import Backend
from executive.run import Fault, FaultSpec
from proving.faults.parameters import Nothing


class ProcessKilled(Fault):
    """The process is killed, a tick after its onset: afterwards nobody could write down that it fired."""

    def __init__(self, parameters: Nothing) -> None:
        self._due = False

    def watch(self, backend: Backend) -> None:
        if self._due:
            os.kill(os.getpid(), signal.SIGKILL)
        self._due = True

    def took_effect(self) -> bool:
        return self._due


PROCESS_KILLED = FaultSpec(
    "process_killed",
    "The executive's process is killed without warning; the record ends there, without a stop.",
    Nothing,
    ProcessKilled,
    "",
    category="executive",
    lasting=True,
)
