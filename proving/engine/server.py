"""The other end of a zygote: start it, hand it cases, hear of their ends."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

from executive.core.errors import LongarmError
from proving.engine.case import Case

START_S = 60.0
_ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMEXPR")}
"""A case has one core; more threads than that only get in the way of its neighbours."""


class EngineError(LongarmError):
    """Children cannot be started on this machine."""


@dataclass(frozen=True)
class Death:
    """How a child ended: exit code, or minus the signal; None if it was never born.

    `killed` is the limit it was killed for: `hang`, `memory`, or nothing.
    """

    key: str
    status: int | None
    killed: str = ""
    wall_s: float = 0.0
    cpu_s: float = 0.0
    memory_bytes: int = 0
    detail: str = ""


class ForkServer:
    """One zygote. `fileno` is readable when `deaths` has something to tell."""

    def __init__(self) -> None:
        self._link, theirs = socket.socketpair()
        with theirs:
            number = theirs.fileno()
            self._process = subprocess.Popen(
                [sys.executable, "-m", "proving.engine.zygote", str(number)],
                pass_fds=[number],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                env=os.environ | _ONE_THREAD | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
                start_new_session=True,  # so that Ctrl-C comes to the supervisor alone
            )
        self._received = b""
        self._alive: dict[str, Case] = {}
        try:
            self._wait_until_ready()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def fileno(self) -> int:
        return self._link.fileno()

    @property
    def alive(self) -> int:
        """How many cases are under way."""
        return len(self._alive)

    def begin(self, case: Case) -> None:
        """Start a case; its key must not be that of another under way."""
        self._alive[case.key] = case
        with suppress(OSError):  # a zygote that is gone is heard of in `deaths`
            self._link.sendall(json.dumps(case.to_json()).encode() + b"\n")

    def deaths(self) -> list[tuple[Case, Death]]:
        """Wait for news; the cases that have ended. When the zygote itself is gone, those are all."""
        try:
            messages = self._messages()
        except EOFError:
            status = self._process.wait()
            gone = f"the process that starts cases ended with {status}"
            lost = [(case, Death(key, None, detail=gone)) for key, case in self._alive.items()]
            self._alive.clear()
            return lost
        return [
            (self._alive.pop(m["died"]), Death(m.pop("died"), **m))
            for m in messages
            if m.get("died") in self._alive
        ]

    @property
    def gone(self) -> bool:
        return self._process.poll() is not None

    def close(self) -> None:
        """End the zygote, and with it every case under way."""
        self._link.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=5.0)
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()

    def _wait_until_ready(self) -> None:
        self._link.settimeout(START_S)
        try:
            (message,) = self._messages()
        except (EOFError, TimeoutError):
            raise EngineError("the process that starts cases did not come up") from None
        if "failed" in message:
            raise EngineError(f"the process that starts cases failed:\n{message['failed']}")
        self._link.settimeout(None)

    def _messages(self) -> list[dict[str, Any]]:
        try:
            got = self._link.recv(1 << 16)
        except ConnectionError:
            got = b""
        if not got:
            raise EOFError
        *lines, self._received = (self._received + got).split(b"\n")
        return [json.loads(line) for line in lines]
