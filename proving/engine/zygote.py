"""A process that has imported what cases need and forks one child per case: a case starts in milliseconds.

Speaks JSON lines over the socket it is given: cases come in, starts and deaths go out. It alone kills its
children, so that no process number is ever reused under it. When the socket closes, it and they are gone.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import resource
import selectors
import signal
import socket
import sys
import traceback
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from executive.core.clock import Stopwatch
from proving.engine import child
from proving.engine.case import Case
from proving.engine.preload import Preloads

WATCH_PERIOD_S = 0.1
LAST_WORDS_S = 1.0
"""How long a hanging child may take to write where it hangs."""
PR_SET_PDEATHSIG = 1
CRASHED = 70


@dataclass
class Living:
    """A child under way."""

    case: Case
    pid: int
    started_bytes: int
    watch: Stopwatch = field(default_factory=Stopwatch)
    killed: str = ""
    memory_bytes: int = 0
    asked_s: float = 0.0


class Zygote:
    """Forks, watches, kills and reaps."""

    def __init__(self, link: socket.socket, preloads: Preloads) -> None:
        self._link, self._preloads = link, preloads
        self._children: dict[str, Living] = {}
        self._received = b""
        self._woken, waker = socket.socketpair()
        for end in (self._woken, waker):
            end.setblocking(False)
        self._waker = waker
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(waker.fileno(), warn_on_full_buffer=False)

    def serve(self) -> None:
        """Until the socket closes."""
        self._tell({"ready": os.getpid()})
        with selectors.DefaultSelector() as selector:
            selector.register(self._link, selectors.EVENT_READ)
            selector.register(self._woken, selectors.EVENT_READ)
            while True:
                selector.select(WATCH_PERIOD_S if self._children else None)
                with suppress(BlockingIOError):
                    self._woken.recv(4096)
                if not self._hear():
                    break
                self._reap()
                for living in self._children.values():
                    self._hold_to_limits(living)
        for living in self._children.values():
            self._kill(living, signal.SIGKILL)

    def _hear(self) -> bool:
        """Do what has been asked; False once nobody asks any more."""
        with suppress(BlockingIOError):
            got = self._link.recv(1 << 16, socket.MSG_DONTWAIT)
            self._received += got
            if not got:
                return False
        *lines, self._received = self._received.split(b"\n")
        for line in lines:
            self._begin(Case.from_json(json.loads(line)))
        return True

    def _begin(self, case: Case) -> None:
        self._load_for(case)
        try:
            pid = os.fork()
        except OSError as error:
            self._tell({"died": case.key, "status": None, "detail": f"fork: {error}"})
            return
        if pid == 0:
            self._become(case)
        self._children[case.key] = Living(case, pid, _resident_bytes(pid))

    def _load_for(self, case: Case) -> None:
        """What fails here is left to the child, which fails alone and says how."""
        with suppress(Exception):
            if self._preloads.load_for(case):
                _share()

    def _become(self, case: Case) -> None:
        """The child's whole life; never returns."""
        code = CRASHED
        try:
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            for end in (self._link, self._woken, self._waker):
                end.close()
            _die_with_parent()
            code = child.run(case)
        finally:
            with suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(code)

    def _reap(self) -> None:
        for key, living in list(self._children.items()):
            pid, status, usage = os.wait4(living.pid, os.WNOHANG)
            if pid:
                del self._children[key]
                self._tell(_obituary(living, status, usage))

    def _hold_to_limits(self, living: Living) -> None:
        used = _resident_bytes(living.pid) - living.started_bytes
        living.memory_bytes = max(living.memory_bytes, used)
        elapsed_s = living.watch.elapsed_s()
        if used > living.case.limits.memory_bytes and not living.killed:
            living.killed = "memory"
            self._kill(living, signal.SIGKILL)
        elif elapsed_s > living.case.limits.wall_s and not living.killed:
            living.killed, living.asked_s = "hang", elapsed_s
            self._kill(living, signal.SIGABRT)  # the fault handler writes where it hangs
        elif living.killed == "hang" and elapsed_s > living.asked_s + LAST_WORDS_S:
            self._kill(living, signal.SIGKILL)

    @staticmethod
    def _kill(living: Living, how: signal.Signals) -> None:
        with suppress(ProcessLookupError):
            os.kill(living.pid, how)

    def _tell(self, message: dict[str, Any]) -> None:
        self._link.sendall(json.dumps(message).encode() + b"\n")


def _obituary(living: Living, status: int, usage: resource.struct_rusage) -> dict[str, Any]:
    return {
        "died": living.case.key,
        "status": os.waitstatus_to_exitcode(status),
        "killed": living.killed,
        "wall_s": living.watch.elapsed_s(),
        "cpu_s": usage.ru_utime + usage.ru_stime,
        "memory_bytes": max(living.memory_bytes, usage.ru_maxrss * 1024 - living.started_bytes),
    }


def _resident_bytes(pid: int) -> int:
    """Memory of a child that is not shared with files [bytes]; 0 once it is gone."""
    try:
        with open(f"/proc/{pid}/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize()
    except (OSError, IndexError):
        return 0


def _die_with_parent() -> None:
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def _share() -> None:
    """Leave what has been loaded out of garbage collection: what is shared with the children stays shared."""
    gc.collect()
    gc.freeze()


def main() -> None:
    """Entry point: the number of the inherited socket is the only argument."""
    link = socket.socket(fileno=int(sys.argv[1]))
    try:
        preloads = Preloads()
        _share()
    except BaseException as error:
        told = "".join(traceback.format_exception(error))
        link.sendall(json.dumps({"failed": told}).encode() + b"\n")
        raise
    Zygote(link, preloads).serve()


if __name__ == "__main__":
    main()
