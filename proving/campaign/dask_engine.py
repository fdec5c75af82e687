"""Cases on a running Dask cluster: each task runs its case in a child on the worker and sends its files home.

Workers need Longarm and the plug-ins installed, and any elevation models at the same paths; no shared folder.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Iterable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4

from executive.core.errors import LongarmError
from executive.core.files import write_whole
from proving.engine import Case, CaseClass, Ending
from proving.engine.server import ForkServer
from proving.engine.supervisor import ATTEMPTS, run_alone

CONNECT_S = 10
_OF_THIS_THREAD = threading.local()

Task = tuple[dict[str, Any], dict[str, bytes]]
"""How a case ended, as JSON, and the files of its folder."""


def run_on_dask(
    address: str, cases: Iterable[Case], slots: int | None, begun: Callable[[Case], None]
) -> Generator[Ending, None, None]:
    """As `run_cases`, on the cluster whose scheduler is at `address`.

    A case whose worker dies is begun anew elsewhere by Dask itself; what Dask gives up is begun once more.
    """
    client_class, as_completed = _distributed()
    try:
        client = client_class(address, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise LongarmError(f"got no Dask scheduler at {address}: {error}") from None
    with client:
        yield from _Cluster(client, as_completed, slots or _threads(client)).run(cases, begun)


def run_task(data: dict[str, Any]) -> Task:
    """One case, on the worker."""
    server = getattr(_OF_THIS_THREAD, "server", None)
    if server is None or server.gone:
        server = _OF_THIS_THREAD.server = ForkServer()
    with TemporaryDirectory(prefix="longarm-") as folder:
        case = Case.from_json(data | {"folder": folder})
        ending = run_alone(server, case)
        written = (path for path in Path(folder).rglob("*") if path.is_file())
        return ending.to_json(), {str(path.relative_to(folder)): path.read_bytes() for path in written}


class _Cluster:
    """Keeps so many tasks under way."""

    def __init__(self, client: Any, as_completed: Any, slots: int) -> None:
        self._client, self._slots = client, slots
        self._futures: dict[str, tuple[Case, int]] = {}
        self._completed = as_completed(raise_errors=False)

    def run(self, cases: Iterable[Case], begun: Callable[[Case], None]) -> Generator[Ending, None, None]:
        waiting = iter(cases)
        while True:
            while len(self._futures) < self._slots and (case := next(waiting, None)) is not None:
                begun(case)
                self._submit(case, 1)
            if not self._futures:
                return
            future = next(self._completed)
            case, attempt = self._futures.pop(future.key)
            ending = _ending(case, attempt, future)
            if ending.kind is CaseClass.INFRASTRUCTURE and attempt < ATTEMPTS:
                self._submit(case, attempt + 1)
            else:
                yield ending

    def _submit(self, case: Case, attempt: int) -> None:
        key = f"case-{case.key}-{uuid4().hex}"
        self._futures[key] = case, attempt
        self._completed.add(self._client.submit(run_task, case.to_json(), key=key, pure=False))


def _ending(case: Case, attempt: int, future: Any) -> Ending:
    """What the task says, its files put where the case wants them; a lost task is the machine's doing."""
    case.folder.mkdir(parents=True, exist_ok=True)
    case.clear()
    if future.status != "finished":
        lost = f"Dask lost the task: {future.status}"
        return Ending(case, CaseClass.INFRASTRUCTURE, "killed", lost, attempts=attempt)
    told, files = future.result()
    for name, content in files.items():
        (case.folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_whole(case.folder / name, content)
    return replace(Ending.from_json(told), case=case, attempts=attempt)


def _threads(client: Any) -> int:
    """All the cluster's threads, and one task more for each so that none waits for the network."""
    return max(1, 2 * int(sum(client.nthreads().values())))


def _distributed() -> tuple[Any, Any]:
    try:
        from distributed import Client, as_completed
    except ImportError:
        message = "--engine dask needs the extra dask: pip install 'longarm[dask]'"
        raise LongarmError(message) from None
    return Client, as_completed
